// The instructions that the loop walk knows. Adds, subtracts and moves follow values that change from
// iteration to iteration; everything else is known for values that stay the same.

#include "emu/dspic/fast/loop_walk.h"

namespace puckloop::dspic {

namespace {

constexpr std::int32_t ones(bool byte) {
    return byte ? 0xFF : 0xFFFF;
}

}  // namespace

bool LoopWalk::holds(FormId id) {
    const auto less = [this] { return flag(n_) != flag(ov_); };
    switch (id) {
    case FormId::BRA_OV_Expr:
        return flag(ov_);
    case FormId::BRA_C_Expr:
        return flag(c_);
    case FormId::BRA_Z_Expr:
        return flag(z_);
    case FormId::BRA_N_Expr:
        return flag(n_);
    case FormId::BRA_LE_Expr:
        return less() || flag(z_);
    case FormId::BRA_LT_Expr:
        return less();
    case FormId::BRA_LEU_Expr:
        return !flag(c_) || flag(z_);
    case FormId::BRA_NOV_Expr:
        return !flag(ov_);
    case FormId::BRA_NC_Expr:
        return !flag(c_);
    case FormId::BRA_NZ_Expr:
        return !flag(z_);
    case FormId::BRA_NN_Expr:
        return !flag(n_);
    case FormId::BRA_GT_Expr:
        return !less() && !flag(z_);
    case FormId::BRA_GE_Expr:
        return !less();
    case FormId::BRA_GTU_Expr:
        return flag(c_) && !flag(z_);
    default:
        fail(Verdict::Unknown);
    }
}

/// Adding, subtracting, moving: what may change from iteration to iteration.
const Op* LoopWalk::execute_data(const Op* op) {
    const bool byte = op->byte;
    const auto wreg = [&] { return get_register(0, byte); };
    const auto base = [&] { return get_register(op->b, byte); };
    const auto file = [&] { return load(op->k, byte); };
    const auto carry = [&] { return flag(c_) ? 1 : 0; };
    const auto to_wreg = [&](Value v) { put_register(0, v, byte); };
    const auto literal = [&] { return Value{op->k, 0}; };
    const auto to_d = [&](Value v) { put_register(op->d, v, byte); };
    switch (op->form) {
    case FormId::MOV_Ws_Wd:
        destination(op, source(op));
        break;
    case FormId::MOV_lit16_Wnd:
        set_w(op->d, literal());
        break;
    case FormId::MOV_B_lit8_Wnd:
        put_register(op->d, literal(), true);
        break;
    case FormId::MOV_f_Wnd:
        set_w(op->d, load(op->k, false));
        break;
    case FormId::MOV_Wns_f:
        store(op->k, w(op->s), false);
        break;
    case FormId::MOV_f_WREG: {
        const Value v = file();
        set_nz(v, byte);
        to_wreg(v);
        break;
    }
    case FormId::MOV_WREG_f:
        store(op->k, wreg(), byte);
        break;
    case FormId::MOV_WsOffset_Wnd:
    case FormId::MOV_Wns_WdOffset: {
        const bool loads = op->form == FormId::MOV_WsOffset_Wnd;
        const int pointer = loads ? op->s : op->d;
        const auto address = static_cast<std::uint16_t>(constant_w(pointer) + op->k);
        if (pointer == 15) check_stack(address);
        if (loads)
            put_register(op->d, load(address, byte), byte);
        else
            store(address, get_register(op->s, byte), byte);
        break;
    }
    case FormId::MOV_D_Ws_Wnd: {
        Value low = w(op->s), high = low;
        if (op->source == Ea::Direct) {
            high = w(op->s + 1);
        } else {
            const std::uint16_t address = step_pointer(op->s, op->s_pre, op->s_post);
            low = load(address, false);
            high = load(static_cast<std::uint16_t>(address + 2), false);
        }
        set_w(op->d, low);
        set_w(op->d + 1, high);
        break;
    }
    case FormId::MOV_D_Wns_Wd: {
        const Value low = w(op->s), high = w(op->s + 1);
        const std::uint16_t address = step_pointer(op->d, op->d_pre, op->d_post);
        store(address, low, false);
        store(static_cast<std::uint16_t>(address + 2), high, false);
        break;
    }
    // clang-format off
#define THREE(NAME, EXPRESSION)                                                                              \
    case FormId::NAME##_Wb_lit5_Wd: case FormId::NAME##_Wb_Ws_Wd: {                                          \
        const Value b = base(); const Value s = source(op); destination(op, EXPRESSION); break; }            \
    case FormId::NAME##_f: { const Value b = file(); const Value s = wreg(); store(op->k, EXPRESSION, byte); break; }  \
    case FormId::NAME##_f_WREG: { const Value b = file(); const Value s = wreg(); to_wreg(EXPRESSION); break; }
#define LITERAL(NAME, EXPRESSION)                                                                            \
    case FormId::NAME##_lit10_Wn: {                                                                          \
        const Value b = get_register(op->d, byte); const Value s = literal(); to_d(EXPRESSION); break; }
    THREE(ADD, add(b, s, 0, byte, false))
    THREE(ADDC, add(b, s, carry(), byte, true))
    THREE(SUB, subtract(b, s, 1, byte, false))
    THREE(SUBB, subtract(b, s, carry(), byte, true))
    THREE(SUBR, subtract(s, b, 1, byte, false))
    THREE(SUBBR, subtract(s, b, carry(), byte, true))
    LITERAL(ADD, add(b, s, 0, byte, false))
    LITERAL(ADDC, add(b, s, carry(), byte, true))
    LITERAL(SUB, subtract(b, s, 1, byte, false))
    LITERAL(SUBB, subtract(b, s, carry(), byte, true))
#undef THREE
#undef LITERAL
#define TWO(NAME, EXPRESSION)                                                                                \
    case FormId::NAME##_Ws_Wd: { const Value s = source(op); destination(op, EXPRESSION); break; }           \
    case FormId::NAME##_f: { const Value s = file(); store(op->k, EXPRESSION, byte); break; }                \
    case FormId::NAME##_f_WREG: { const Value s = file(); to_wreg(EXPRESSION); break; }
    TWO(INC, add(s, {1, 0}, 0, byte, false))
    TWO(INC2, add(s, {2, 0}, 0, byte, false))
    TWO(DEC, subtract(s, {1, 0}, 1, byte, false))
    TWO(DEC2, subtract(s, {2, 0}, 1, byte, false))
#undef TWO
        // clang-format on
    case FormId::CP_Wb_lit5:
    case FormId::CP_Wb_Ws:
    case FormId::CPB_Wb_lit5:
    case FormId::CPB_Wb_Ws: {
        const bool borrow = op->form == FormId::CPB_Wb_lit5 || op->form == FormId::CPB_Wb_Ws;
        const Value b = base();
        const Value s = source(op);
        subtract(b, s, borrow ? carry() : 1, byte, borrow);
        break;
    }
    case FormId::CP_f: {
        const Value b = file();
        subtract(b, wreg(), 1, byte, false);
        break;
    }
    case FormId::CPB_f: {
        const Value b = file();
        subtract(b, wreg(), carry(), byte, true);
        break;
    }
    case FormId::CP0_Ws:
        subtract(source(op), {0, 0}, 1, byte, false);
        break;
    case FormId::CP0_f:
        subtract(file(), {0, 0}, 1, byte, false);
        break;
    default:
        return execute_logic(op);
    }
    return op + 1;
}

/// Everything else: known for inputs that stay the same.
const Op* LoopWalk::execute_logic(const Op* op) {
    const bool byte = op->byte;
    const auto base = [&] { return constant(get_register(op->b, byte)); };
    const auto from = [&] { return constant(source(op)); };
    const auto result = [&](std::uint32_t r) {
        const Value v = {static_cast<std::int32_t>(r) & ones(byte), 0};
        set_nz(v, byte);
        return v;
    };
    const auto shifted = [&](std::uint32_t r, std::uint32_t out) {
        c_ = {true, out != 0};
        return result(r);
    };
    switch (op->form) {
        // clang-format off
#define LOGIC(NAME, SIGN)                                                                                    \
    case FormId::NAME##_Wb_lit5_Wd: case FormId::NAME##_Wb_Ws_Wd: {                                          \
        const std::uint32_t b = base(); destination(op, result(b SIGN from())); break; }                     \
    case FormId::NAME##_lit10_Wn:                                                                            \
        put_register(op->d, result(constant(get_register(op->d, byte)) SIGN op->k), byte); break;            \
    case FormId::NAME##_f_WREG:                                                                              \
        put_register(0, result(constant(load(op->k, byte)) SIGN constant(get_register(0, byte))), byte); break;
    LOGIC(AND, &)
    LOGIC(IOR, |)
    LOGIC(XOR, ^)
#undef LOGIC
        // clang-format on
    case FormId::COM_Ws_Wd:
        destination(op, result(~from()));
        break;
    case FormId::CLR_Wd:
    case FormId::SETM_Wd:
        destination(op, {op->form == FormId::CLR_Wd ? 0 : ones(byte), 0});
        break;
    case FormId::CLR_WREG:
    case FormId::SETM_WREG:
        put_register(0, {op->form == FormId::CLR_WREG ? 0 : ones(byte), 0}, byte);
        break;
    case FormId::CLR_f:
    case FormId::SETM_f:
        store(op->k, {op->form == FormId::CLR_f ? 0 : ones(byte), 0}, byte);
        break;
    case FormId::SL_Ws_Wd: {
        const std::uint32_t s = from();
        destination(op, shifted(s << 1, s & (byte ? 0x80 : 0x8000)));
        break;
    }
    case FormId::LSR_Ws_Wd: {
        const std::uint32_t s = from();
        destination(op, shifted(s >> 1, s & 1));
        break;
    }
    case FormId::SL_Wb_lit4_Wnd:
        set_w(op->d, result(constant_w(op->b) << op->k));
        break;
    case FormId::LSR_Wb_lit4_Wnd:
        set_w(op->d, result(std::uint32_t{constant_w(op->b)} >> op->k));
        break;
    case FormId::ZE_Ws_Wnd:
    case FormId::SE_Ws_Wnd: {
        const std::uint32_t s = op->source == Ea::Direct
                                    ? constant(get_register(op->s, true))
                                    : constant(load(step_pointer(op->s, op->s_pre, op->s_post), true));
        const bool negative = op->form == FormId::SE_Ws_Wnd && s & 0x80;
        set_w(op->d, result(negative ? s | 0xFF00 : s));
        c_ = {true, !negative};
        break;
    }
    case FormId::MUL_UU_Wb_lit5_Wnd:
    case FormId::MUL_UU_Wb_Ws_Wnd: {
        const std::uint32_t b = constant_w(op->b);
        const std::uint32_t product = b * from();
        set_w(op->d, {static_cast<std::int32_t>(product & 0xFFFF), 0});
        set_w(op->d + 1, {static_cast<std::int32_t>(product >> 16), 0});
        break;
    }
    case FormId::BTST_f_bit4:
        z_ = {true, !(constant(load(op->k, true)) & op->aux)};
        break;
    case FormId::BTST_Z_Ws_bit4:
        z_ = {true, !(from() & op->k)};
        break;
    case FormId::BTST_C_Ws_bit4:
        c_ = {true, (from() & op->k) != 0};
        break;
    default:
        return execute_skip(op);
    }
    return op + 1;
}

const Op* LoopWalk::execute_skip(const Op* op) {
    bool skip = false;
    switch (op->form) {
    case FormId::BTSS_f_bit4:
    case FormId::BTSC_f_bit4: {
        const bool bit = constant(load(op->k, true)) & op->aux;
        skip = bit == (op->form == FormId::BTSS_f_bit4);
        break;
    }
    case FormId::BTSS_Ws_bit4:
    case FormId::BTSC_Ws_bit4: {
        std::uint32_t value = 0;
        if (op->source == Ea::Direct)
            value = constant_w(op->s);
        else
            value = constant(load(step_pointer(op->s, op->s_pre, op->s_post), false));
        const bool bit = value & op->k;
        skip = bit == (op->form == FormId::BTSS_Ws_bit4);
        break;
    }
    default:
        fail(Verdict::Unknown);
    }
    if (!skip) return op + 1;
    const bool two = is_two_words(op[1].word);
    plan_.cycles += two ? 2 : 1;
    return op + (two ? 3 : 2);
}

void LoopWalk::hazards(const Op* op) {
    if (op->run == &decode_now || op->marks != 0) fail(Verdict::NotNow);
    if (op->uses & m_.watch & 0xFFFF0000) fail(Verdict::NotNow);
    if (op->uses & watch_) ++plan_.cycles;
    watch_ = op->writes;
}

const Op* LoopWalk::execute(const Op* op) {
    const auto to = [&](std::uint32_t pc) {
        if (pc >> 1 >= m_.code_words) fail(Verdict::NotNow);
        return static_cast<const Op*>(m_.code + (pc >> 1));
    };
    switch (op->form) {
    case FormId::BRA_Expr:
    case FormId::GOTO_Expr:
        return to(op->target);
    case FormId::NOP:
    case FormId::NOPR:
        return op + 1;
    case FormId::CLRWDT:
        plan_.clears_watchdog = true;
        return op + 1;
    case FormId::CALL_Expr:
    case FormId::RCALL_Expr: {
        const std::uint32_t back = m_.pc_of(op) + op->k;
        push(static_cast<std::uint16_t>(back));
        push(static_cast<std::uint16_t>(back >> 16));
        return to(op->target);
    }
    case FormId::RETURN: {
        const std::uint32_t high = pop() & 0x7Fu;
        return to(high << 16 | (pop() & 0xFFFEu));
    }
    case FormId::LNK_lit14:
        push(constant_w(14));
        set_w(14, w(15));
        set_w(15, {static_cast<std::uint16_t>(constant_w(15) + op->k), 0});
        return op + 1;
    case FormId::ULNK:
        set_w(15, w(14));
        set_w(14, {pop(), 0});
        return op + 1;
    default:
        break;
    }
    if (op->form >= FormId::BRA_OV_Expr && op->form <= FormId::BRA_GTU_Expr) {
        chose_ = true;
        if (!holds(op->form)) return op + 1;
        ++plan_.cycles;
        return to(op->target);
    }
    return execute_data(op);
}

}  // namespace puckloop::dspic
