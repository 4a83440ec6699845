#include "emu/dspic/fast/path_domain.h"

#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/machine/execute/semantics.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr int kMostOnPath = 600;
constexpr std::size_t kMostArrivals = 8;
constexpr std::uint16_t kStackPointer = 2 * 15;  ///< W15's data address

constexpr std::uint16_t even(std::uint16_t address) {
    return address & 0xFFFE;
}
/// A register of the core's own that routines save, and that nothing acts on before they restore it.
constexpr bool is_saved_register(std::uint16_t address) {
    return address == sfr::RCOUNT || address == sfr::PSVPAG;
}
constexpr std::uint16_t bits_of_saved(std::uint16_t address) {
    return address == sfr::RCOUNT ? 0x3FFF : 0xFF;
}

}  // namespace

PathDomain::PathDomain(Machine& m, IsrPath& result, int irq, Cycle start)
    : m_(m), path_(result), irq_(irq), start_(start) {
    for (std::uint16_t reg = 0; reg < 16; ++reg)
        w_[reg].whole = found(static_cast<std::uint16_t>(2 * reg));
    w_[15].whole = plus(w_[15].whole, kExceptionFrame);
    path_.depth = kExceptionFrame;
}

bool PathDomain::walk(const Op* op) {
    try {
        std::uint32_t writes = 0;
        path_.keep = 0xFFFFFFFF;
        for (int i = 0; i < kMostOnPath; ++i) {
            if (op->run == &decode_now || op->marks != 0) return false;
            instruction_ = path_.cycles;
            if (op->uses & writes & 0xFFFF) ++path_.cycles;
            path_.uses |= op->uses & 0xFFFF0000 & path_.keep;
            path_.keep &= op->keep;
            writes = op->writes;
            path_.cycles += op->cycles;
            ++path_.instructions;
            if (op->form == FormId::RETFIE) {
                path_.writes = writes;
                path_.returns = instruction_;
                finish();
                return true;
            }
            op = execute_in(*this, op);
            if (op == nullptr) return false;
        }
    } catch (const Stop&) {
    }
    return false;
}

// --- numbers and what they hang on -----------------------------------------------------------------------

const std::uint16_t* PathDomain::cell(std::uint16_t address) const {
    if (address < kWEnd) return &m_.st.w[address / 2u];
    if (address == sfr::RCOUNT) return &m_.st.rcount;
    if (address == sfr::PSVPAG) return &m_.st.psvpag;
    if (address < kRamStart) return &m_.sfr.raw(address);
    return m_.ram + (address - kRamStart) / 2;
}

PathDomain::Value PathDomain::found(std::uint16_t at) const {
    return {Kind::Word, at, 0, *cell(at)};
}

/// The path is this one as long as the value lies within [low, high]; it does now.
void PathDomain::hold(const Value& value, int low, int high) {
    const int difference = value.now - *cell(value.cell);
    auto bound = std::find_if(bounds_.begin(), bounds_.end(),
                              [&](const Bound& known) { return known.cell == value.cell; });
    if (bound == bounds_.end()) bound = bounds_.insert(bound, {value.cell, 0, 0xFFFF});
    bound->low = std::max(bound->low, low - difference);
    bound->high = std::min(bound->high, high - difference);
}

void PathDomain::hold_between(const Value& value, std::initializer_list<std::uint32_t> changes) {
    int low = 0, high = 0xFFFF;
    for (const std::uint32_t change : changes) {
        const auto at = static_cast<std::uint16_t>(change);
        if (at <= value.now)
            low = std::max<int>(low, at);
        else
            high = std::min<int>(high, at - 1);
    }
    hold(value, low, high);
}

std::uint32_t PathDomain::word(const Value& value) {
    switch (value.kind) {
    case Kind::Constant:
        break;
    case Kind::Word:
        hold(value, value.now, value.now);
        break;
    case Kind::LowByte:
    case Kind::HighByte: {
        const Value whole = found(value.cell);
        hold(whole, whole.now, whole.now);
        break;
    }
    case Kind::Unknown:
        throw Stop{};
    }
    return value.now;
}

PathDomain::Value PathDomain::plus(Value value, std::uint16_t offset) {
    if (value.kind != Kind::Constant && value.kind != Kind::Word) throw Stop{};
    value.now = static_cast<std::uint16_t>(value.now + offset);
    if (value.kind == Kind::Word) value.offset = static_cast<std::uint16_t>(value.offset + offset);
    return value;
}

// --- a word and its bytes --------------------------------------------------------------------------------

PathDomain::Value PathDomain::byte_of(const Value& word, bool high) {
    const auto now = static_cast<std::uint16_t>(high ? word.now >> 8 : word.now & 0xFF);
    if (word.kind == Kind::Unknown) return word;
    if (word.kind == Kind::Word && word.offset == 0)
        return {high ? Kind::HighByte : Kind::LowByte, word.cell, 0, now};
    this->word(word);
    return value(now);
}

PathDomain::Value PathDomain::half(const Slot& slot, bool high) {
    if (!slot.split) return byte_of(slot.whole, high);
    return high ? slot.high : slot.low;
}

void PathDomain::set_half(Slot& slot, bool high, const Value& byte) {
    if (!slot.split) slot = {{}, true, byte_of(slot.whole, false), byte_of(slot.whole, true)};
    (high ? slot.high : slot.low) = byte;
}

PathDomain::Value PathDomain::joined(Slot& slot) {
    if (!slot.split) return slot.whole;
    const Value& low = slot.low;
    const Value& high = slot.high;
    Value whole;
    if (low.kind == Kind::LowByte && high.kind == Kind::HighByte && low.cell == high.cell)
        whole = found(low.cell);
    else
        whole = value(word(low) | word(high) << 8);
    slot = {whole};
    return whole;
}

// --- registers and memory --------------------------------------------------------------------------------

void PathDomain::set_whole(int reg, const Value& value) {
    if (reg == 15) {
        const bool above = value.kind == Kind::Word && value.cell == kStackPointer &&
                           value.offset >= kExceptionFrame && value.offset % 2 == 0;
        if (!above) throw Stop{};
        reach(value.offset);
    }
    w_[static_cast<std::size_t>(reg)] = {value};
}

void PathDomain::put(int reg, bool byte, const Value& value) {
    if (!byte) return set_whole(reg, value);
    if (reg == 15) throw Stop{};
    set_half(w_[static_cast<std::size_t>(reg)], false, value);
}

/// A read of the register, now, is a look at the stored word.
void PathDomain::check_readable(std::uint16_t at) {
    if (is_saved_register(at)) return;
    const DeviceInfo& device = m_.device;
    const bool flags = at >= device.ifs && at < device.ifs + 2 * device.ifs_words;
    const SfrSpace::Plain& plain = m_.sfr.plain();
    const std::uint8_t kind = plain.kind[at / 2u];
    if (at < kWEnd || flags || (device.inttreg && at == device.inttreg) || kind == SfrSpace::Plain::kNever ||
        start_ + instruction_ >= plain.until[kind])
        throw Stop{};
    if (kind != SfrSpace::Plain::kConverter) return;
    path_.converts = true;
    path_.last_conversion = instruction_;
}

PathDomain::Place& PathDomain::known_place(bool stack, std::uint16_t at) {
    for (Place& place : places_)
        if (place.stack == stack && place.at == at) return place;
    const Value there = stack ? Value{Kind::Unknown} : found(at);
    return places_.emplace_back(Place{stack, at, {there}});
}

/// Of RAM, or of the stack above the interrupted program's.
PathDomain::Place& PathDomain::place(const Address& at, bool byte, bool writes) {
    const bool stack = at.kind == Kind::Word && at.cell == kStackPointer;
    const auto number = static_cast<std::uint16_t>(stack ? at.offset : word(at));
    if (!byte && number % 2 != 0) throw Stop{};
    const std::uint16_t aligned = even(number);
    if (stack) {
        if (writes && aligned < kExceptionFrame) throw Stop{};
        reach(aligned + 2u);
    } else if (aligned < kRamStart) {
        check_readable(aligned);
    } else {
        if ((aligned - kRamStart) / 2 >= m_.ram_words) throw Stop{};
        path_.lowest = std::min(path_.lowest, aligned);
        path_.highest = std::max<std::uint16_t>(path_.highest, aligned | 1);
    }
    return known_place(stack, aligned);
}

PathDomain::Value PathDomain::load(const Address& at, bool byte) {
    Slot& slot = place(at, byte, false).slot;
    return byte ? half(slot, at.now & 1) : joined(slot);
}

void PathDomain::store(const Address& at, bool byte, const Value& value) {
    const bool stack = at.kind == Kind::Word && at.cell == kStackPointer;
    if (!stack && even(at.now) < kRamStart) return store_register(at, byte, value);
    Place& there = place(at, byte, true);
    there.written = true;
    if (byte)
        set_half(there.slot, at.now & 1, value);
    else
        there.slot = {value};
}

void PathDomain::store_register(const Address& at, bool byte, const Value& value) {
    const auto address = static_cast<std::uint16_t>(word(at));
    if (byte || address % 2 != 0 || address < kWEnd) throw Stop{};
    if (is_saved_register(address)) {
        if (value.kind != Kind::Constant && value != found(address)) throw Stop{};
        const bool constant = value.kind == Kind::Constant;
        known_place(false, address).slot = {constant ? PathDomain::value(value.now & bits_of_saved(address))
                                                     : value};
        return;
    }
    // Of a module: may be written what it holds.
    const Value held = found(address);
    if (!m_.sfr.idempotent(address) || word(value) != held.now) throw Stop{};
    hold(held, held.now, held.now);
}

/// The routine's own interrupt flag, and nothing else, is cleared.
bool PathDomain::clears_flag(const Address& at, bool byte, std::uint32_t set, std::uint32_t kept) {
    const auto flags = static_cast<std::uint16_t>(m_.device.ifs + irq_ / 8);
    const bool does = byte && at == address(flags) && set == 0 && (kept ^ 0xFF) == 1u << irq_ % 8;
    flag_cleared_ = flag_cleared_ || does;
    return does;
}

// --- flags -----------------------------------------------------------------------------------------------

PathDomain::Value PathDomain::add(bool byte, bool sticky, Value a, Value b, bool carry) {
    if (a.kind == Kind::Constant) std::swap(a, b);
    if (byte) a = value(word(a));
    b = value(word(b));
    const Flag z_before = z_;
    const bool stays_clear = sticky && z_before.from != Flag::From::Program && !z();
    sum_ = {a, b, byte, carry, true};
    c_ = n_ = ov_ = z_ = {Flag::From::Sum, false};
    if (stays_clear) z_ = known(false);
    if (sticky && z_before.from == Flag::From::Program) z_ = {};
    const Value result = plus(a, static_cast<std::uint16_t>(b.now + (carry ? 1 : 0)));
    return byte ? value(result.now & 0xFFu) : result;
}

PathDomain::Value PathDomain::logic(bool byte, const Value& result) {
    const std::uint32_t number = word(result);
    n_ = known(number & top(byte));
    z_ = known((number & ones(byte)) == 0);
    return value(number & ones(byte));
}

PathDomain::Value PathDomain::moved(bool byte, const Value& value) {
    if (byte || value.kind != Kind::Word) {
        logic(byte, value);
        return value;
    }
    moved_ = value;
    n_ = z_ = {Flag::From::Moved, false};
    return value;
}

bool PathDomain::flag(Flag& flag, std::uint16_t bit) {
    if (flag.from == Flag::From::Program) throw Stop{};
    if (flag.from == Flag::From::Sum) flag = known(flag_of_sum(bit));
    if (flag.from == Flag::From::Moved) flag = known(flag_of_moved(bit));
    return flag.value;
}

/// As the first operand grows, the second being what it is, flags change where the sum passes 0 and the
/// greatest positive number, and OV where that operand does.
bool PathDomain::flag_of_sum(std::uint16_t bit) {
    const std::uint32_t a = sum_.a.now, b = sum_.b.now;
    const std::uint32_t sum = a + b + (sum_.carry ? 1u : 0u);
    const std::uint32_t to_zero = a - sum, sign = top(sum_.byte);
    const bool follows = sum_.a.kind == Kind::Word;
    switch (bit) {
    case sr::C:
        if (follows) hold_between(sum_.a, {to_zero});
        return sum > ones(sum_.byte);
    case sr::Z:
        if (follows) hold_between(sum_.a, {to_zero, to_zero + 1});
        return (sum & ones(sum_.byte)) == 0;
    case sr::N:
        if (follows) hold_between(sum_.a, {to_zero, to_zero + sign});
        return sum & sign;
    default:
        if (follows) hold_between(sum_.a, {sign, to_zero, to_zero + sign});
        return (a ^ sum) & (b ^ sum) & sign;
    }
}

bool PathDomain::flag_of_moved(std::uint16_t bit) {
    hold_between(moved_, {bit == sr::Z ? 1u : 0x8000u});
    return bit == sr::Z ? moved_.now == 0 : moved_.now >= 0x8000;
}

// --- flow ------------------------------------------------------------------------------------------------

/// Op::may_skip may have been taken back; going back to a mark restores it, and the path stays.
bool PathDomain::may_close_loop(const Op* op) const {
    constexpr std::uint32_t kFarthest = 128;  // as decoding has it
    const std::uint32_t pc = pc_of(op);
    return op->target <= pc && pc - op->target <= kFarthest;
}

const Op* PathDomain::branch(const Op* op, bool conditional) {
    const Op* const next = SymbolicExecution::branch(op, conditional);
    if (may_close_loop(op)) arrive(op, next, instruction_ + (conditional ? 1 : 0));
    return next;
}

void PathDomain::arrive(const Op* branch, const Op* head, Cycle at) {
    auto& arrivals = path_.arrivals;
    const std::uint16_t depth = whole(15).offset;
    if (!arrivals.empty() && arrivals.back().branch == branch && arrivals.back().depth == depth) {
        arrivals.back().last = at;
        return;
    }
    if (arrivals.size() == kMostArrivals) throw Stop{};
    arrivals.push_back({branch, head, depth, at, at});
}

// --- the outcome -----------------------------------------------------------------------------------------

IsrPath::Term PathDomain::term(const Value& value) const {
    if (value.kind == Kind::Constant) return {.constant = value.now};
    if (value.kind == Kind::Word) return {cell(value.cell), value.offset};
    throw Stop{};
}

void PathDomain::finish() {
    Slot above = w_[15];
    if (joined(above) != plus(found(kStackPointer), kExceptionFrame) || !flag_cleared_) throw Stop{};
    const auto change = [this](std::uint16_t address, Slot& slot) {
        const Value value = joined(slot);
        if (value != found(address))
            path_.stores.push_back({const_cast<std::uint16_t*>(cell(address)), term(value)});
    };
    for (std::uint16_t reg = 0; reg < 15; ++reg)
        change(static_cast<std::uint16_t>(2 * reg), w_[reg]);
    for (Place& place : places_) {
        if (is_saved_register(place.at) && !place.stack && joined(place.slot) != found(place.at))
            throw Stop{};
        if (!place.written) continue;
        if (place.stack)
            path_.pushes.push_back({static_cast<std::uint16_t>(place.at / 2), term(joined(place.slot))});
        else
            change(place.at, place.slot);
    }
    order_stores();
    if (sum_.done) path_.sum = {true, sum_.byte, sum_.carry, term(sum_.a), term(sum_.b)};
    for (const Bound& bound : bounds_)
        if (bound.low > 0 || bound.high < 0xFFFF)
            path_.guards.push_back({cell(bound.cell), static_cast<std::uint16_t>(bound.low),
                                    static_cast<std::uint16_t>(bound.high - bound.low)});
    path_.guards.shrink_to_fit();
    path_.arrivals.shrink_to_fit();
    path_.pushes.shrink_to_fit();
    path_.stores.shrink_to_fit();
}

/// Constants last; what is read is not written before, if that is possible.
void PathDomain::order_stores() {
    auto& stores = path_.stores;
    std::stable_partition(stores.begin(), stores.end(),
                          [](const IsrPath::Store& store) { return store.term.reads(); });
    for (auto store = stores.begin(); store != stores.end(); ++store)
        if (std::any_of(stores.begin(), store,
                        [&](const IsrPath::Store& earlier) { return earlier.to == store->term.word; }))
            path_.at_once = true;
}

}  // namespace puckloop::dspic
