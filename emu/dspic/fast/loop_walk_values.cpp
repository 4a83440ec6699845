// What the loop walk computes with: cells, their steps, and the bounds within which they hold.

#include "emu/dspic/fast/loop_walk.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr std::int32_t ones(bool byte) {
    return byte ? 0xFF : 0xFFFF;
}

}  // namespace

// --- cells -----------------------------------------------------------------------------------------------

SkipLoops::Cell& LoopWalk::cell(std::uint16_t key) {
    if (key < 16 && w_[key]) return *w_[key];
    for (std::size_t i = 0; i < plan_.count; ++i)
        if (plan_.cells[i].key == key) return plan_.cells[i];
    if (plan_.count == plan_.cells.size()) fail(Verdict::NotNow);
    SkipLoops::Cell& fresh = plan_.cells[plan_.count++];
    fresh = {};
    fresh.key = key;
    fresh.start = key < 16 ? m_.st.w[key] : probed(key, m_.ram[(key - kRamStart) / 2]);
    fresh.now = fresh.start;
    if (key < 16) w_[key] = &fresh;
    for (std::size_t i = 0; i < first_count_; ++i)
        if (first_[i].key == key) fresh.step = fresh.now_step = first_[i].step;
    return fresh;
}

LoopWalk::Value LoopWalk::read_cell(std::uint16_t key) {
    SkipLoops::Cell& c = cell(key);
    if (!c.written) c.carried = true;
    if (key >= 16) note_access(key, c.now, false);
    return {c.now, c.now_step};
}

void LoopWalk::write_cell(std::uint16_t key, Value value) {
    SkipLoops::Cell& c = cell(key);
    c.written = true;
    c.now = value.v;
    c.now_step = value.step;
    if (key >= 16) note_access(key, value.v, true);
}

void LoopWalk::note_access(std::uint16_t address, std::int32_t value, bool write) {
    trace_.accesses.push_back({static_cast<std::uint32_t>(trace_.boundaries.size() - 1), address,
                               static_cast<std::uint16_t>(value), write});
}

void LoopWalk::set_w(int reg, Value value) {
    if (reg == 15) value = {static_cast<std::int32_t>(constant(value)) & 0xFFFE, 0};
    write_cell(static_cast<std::uint16_t>(reg), value);
}

std::uint32_t LoopWalk::constant(Value value) {
    if (value.step != 0) fail(Verdict::NotNow);
    return static_cast<std::uint32_t>(value.v);
}

std::uint16_t LoopWalk::constant_w(int reg) {
    return static_cast<std::uint16_t>(constant(w(reg)));
}

void LoopWalk::check_stack(std::uint16_t address) const {
    if (static_cast<std::uint16_t>(address - kRamStart) > m_.stack_span) fail(Verdict::NotNow);
}

/// [Wn] with its modification; the pointer may not move from one iteration to the next.
std::uint16_t LoopWalk::step_pointer(int reg, int pre, int post) {
    if (reg != 15 && m_.special >> reg & 1) fail(Verdict::NotNow);
    const auto address = static_cast<std::uint16_t>(constant_w(reg) + pre);
    if (pre != 0 || post != 0) set_w(reg, {static_cast<std::uint16_t>(address + post), 0});
    if (reg == 15) check_stack(address);
    return address;
}

/// One byte of a word whose other byte stays put.
LoopWalk::Value LoopWalk::half(Value word, bool high) {
    const int shift = high ? 8 : 0;
    if (word.step == 0) return {word.v >> shift & 0xFF, 0};
    if (high) fail(Verdict::NotNow);
    hold(word.v & 0xFF, word.step, 0, 0xFF);
    return {word.v & 0xFF, word.step};
}

LoopWalk::Value LoopWalk::joined(Value word, Value byte, bool high) {
    if (high)
        return {(word.v & 0xFF) | static_cast<std::int32_t>(constant(byte)) << 8, half(word, false).step};
    if (word.step != 0) half(word, false);  // its upper byte must stay
    return {(word.v & 0xFF00) | byte.v, byte.step};
}

LoopWalk::Value LoopWalk::load(std::uint16_t address, bool byte) {
    const auto even = static_cast<std::uint16_t>(address & 0xFFFE);
    if (!byte && even != address) fail(Verdict::NotNow);
    Value word;
    if (even >= kRamStart && (even - kRamStart) / 2 < m_.ram_words) {
        word = read_cell(even);
    } else if (even < kRamStart) {
        // A register: constant until the next event if nothing happens at a read.
        const bool known = probe_.on ? m_.sfr.quiet(even) : m_.sfr.plain_read(even);
        if (even < kWEnd || !known) fail(Verdict::NotNow);
        word = {poll(even), 0};
    } else {
        fail(Verdict::NotNow);
    }
    return byte ? half(word, address & 1) : word;
}

/// A register's value, noted as one of the plan's conditions.
std::uint16_t LoopWalk::poll(std::uint16_t address) {
    const std::uint16_t value = probe_.on ? probed(address, m_.sfr.quiet_read(address)) : m_.sfr.raw(address);
    for (std::size_t i = 0; i < plan_.polled_count; ++i)
        if (plan_.polled[i].address == address) return value;
    if (plan_.polled_count == plan_.polled.size()) fail(Verdict::NotNow);
    plan_.polled[plan_.polled_count++] = {address, value};
    return value;
}

void LoopWalk::store(std::uint16_t address, Value value, bool byte) {
    const auto even = static_cast<std::uint16_t>(address & 0xFFFE);
    if ((!byte && even != address) || even < kRamStart || (even - kRamStart) / 2 >= m_.ram_words)
        fail(Verdict::NotNow);
    write_cell(even, byte ? joined(read_cell(even), value, address & 1) : value);
}

LoopWalk::Value LoopWalk::get_register(int reg, bool byte) {
    return byte ? half(w(reg), false) : w(reg);
}
void LoopWalk::put_register(int reg, Value value, bool byte) {
    set_w(reg, byte ? joined(w(reg), value, false) : value);
}

LoopWalk::Value LoopWalk::source(const Op* op) {
    switch (op->source) {
    case Ea::Literal:
        return {op->byte ? op->k & 0xFF : op->k, 0};
    case Ea::Direct:
        return get_register(op->s, op->byte);
    case Ea::Indirect:
        return load(step_pointer(op->s, op->s_pre, op->s_post), op->byte);
    case Ea::Offset:
        break;
    }
    if (m_.special >> op->s & 1) fail(Verdict::NotNow);
    return load(static_cast<std::uint16_t>(constant_w(op->s) + constant_w(op->b)), op->byte);
}

void LoopWalk::destination(const Op* op, Value value) {
    switch (op->destination) {
    case Ea::Direct:
        return put_register(op->d, value, op->byte);
    case Ea::Indirect:
        return store(step_pointer(op->d, op->d_pre, op->d_post), value, op->byte);
    case Ea::Offset:
        if (m_.special >> op->d & 1) fail(Verdict::NotNow);
        return store(static_cast<std::uint16_t>(constant_w(op->d) + constant_w(op->b)), value, op->byte);
    case Ea::Literal:
        break;
    }
    fail(Verdict::Unknown);
}

void LoopWalk::push(std::uint16_t value) {
    const std::uint16_t address = step_pointer(15, 0, 2);
    store(address, {value, 0}, false);
}
std::uint16_t LoopWalk::pop() {
    return static_cast<std::uint16_t>(constant(load(step_pointer(15, -2, 0), false)));
}

// --- arithmetic ------------------------------------------------------------------------------------------

/// Lowers the bound so that value + step * n stays within [low, high]; it is there for n = 0.
void LoopWalk::hold(std::int64_t value, std::int64_t step, std::int64_t low, std::int64_t high) {
    if (step > 0) bound_ = std::min(bound_, static_cast<std::uint64_t>((high - value) / step));
    if (step < 0) bound_ = std::min(bound_, static_cast<std::uint64_t>((value - low) / -step));
}

void LoopWalk::set_nz(Value result, bool byte) {
    const std::int32_t half_way = byte ? 0x80 : 0x8000;
    const bool negative = result.v >= half_way;
    hold(result.v, result.step, negative ? half_way : 0, negative ? ones(byte) : half_way - 1);
    if (result.v != 0)
        hold(result.v, result.step, 1, ones(byte));
    else if (result.step != 0)
        bound_ = 0;
    n_ = {true, negative};
    z_ = {true, result.v == 0};
}

LoopWalk::Value LoopWalk::add(Value a, Value b, int carry, bool byte, bool sticky_z) {
    const std::int32_t width = ones(byte) + 1;
    const std::int32_t half_way = width / 2;
    const std::int32_t sum = a.v + b.v + carry;
    const std::int32_t step = a.step + b.step;
    const std::int32_t base = sum >= width ? width : 0;
    hold(sum, step, base, base + width - 1);
    const Value result = {sum - base, step};
    for (const Value& operand : {a, b}) {  // the signs make OV
        const bool negative = operand.v >= half_way;
        hold(operand.v, operand.step, negative ? half_way : 0, negative ? width - 1 : half_way - 1);
    }
    const bool z_before = !sticky_z || flag(z_);
    set_nz(result, byte);
    z_.value = z_.value && z_before;
    c_ = {true, base != 0};
    const bool sign_a = a.v >= half_way, sign_b = b.v >= half_way, sign_r = result.v >= half_way;
    ov_ = {true, sign_a == sign_b && sign_r != sign_a};
    return result;
}

LoopWalk::Value LoopWalk::subtract(Value a, Value b, int carry, bool byte, bool sticky_z) {
    return add(a, {ones(byte) - b.v, -b.step}, carry, byte, sticky_z);
}

bool LoopWalk::flag(Flag& flag) {
    if (!flag.known) fail(Verdict::NotNow);  // set before the loop's head
    return flag.value;
}

}  // namespace puckloop::dspic
