#include "emu/dspic/walk/affine_domain.h"

#include <algorithm>

namespace puckloop::dspic {

// --- cells -----------------------------------------------------------------------------------------------

LoopPlan::Cell& AffineDomain::cell(std::uint16_t key) {
    if (key < 16 && w_[key]) return *w_[key];
    for (std::size_t i = 0; i < plan_.count; ++i)
        if (plan_.cells[i].key == key) return plan_.cells[i];
    if (plan_.count == plan_.cells.size()) fail(Verdict::NotNow);
    LoopPlan::Cell& fresh = plan_.cells[plan_.count++];
    fresh = {};
    fresh.key = key;
    fresh.start = key < 16 ? m_.st.w[key] : probed(key, m_.ram[(key - kRamStart) / 2]);
    fresh.now = fresh.start;
    if (key < 16) w_[key] = &fresh;
    for (std::size_t i = 0; i < first_count_; ++i)
        if (first_[i].key == key) fresh.step = fresh.now_step = first_[i].step;
    return fresh;
}

AffineDomain::Value AffineDomain::read_cell(std::uint16_t key) {
    LoopPlan::Cell& c = cell(key);
    if (!c.written) c.carried = true;
    if (key >= 16) note_access(key, {c.now, c.now_step}, false);
    return {c.now, c.now_step};
}

void AffineDomain::write_cell(std::uint16_t key, Value value) {
    LoopPlan::Cell& c = cell(key);
    c.written = true;
    c.now = value.v;
    c.now_step = value.step;
    if (key >= 16)
        note_access(key, value, true);
    else
        trace_.boundaries.back().writes |= static_cast<std::uint16_t>(1u << key);
}

void AffineDomain::note_access(std::uint16_t address, Value value, bool write) {
    trace_.accesses.push_back({static_cast<std::uint32_t>(trace_.boundaries.size() - 1), address,
                               static_cast<std::uint16_t>(value.v), write,
                               static_cast<std::int16_t>(value.step)});
}

void AffineDomain::set_whole(int reg, Value value) {
    if (reg == 15) value = {static_cast<std::int32_t>(word(value)) & 0xFFFE, 0};
    write_cell(static_cast<std::uint16_t>(reg), value);
}

std::uint32_t AffineDomain::word(Value value) {
    if (value.step != 0) fail(Verdict::NotNow);
    return static_cast<std::uint32_t>(value.v);
}

// --- memory ----------------------------------------------------------------------------------------------

void AffineDomain::check_stack(Address at) const {
    if (static_cast<std::uint16_t>(at - kRamStart) > m_.stack_span) fail(Verdict::NotNow);
}

AffineDomain::Address AffineDomain::step_pointer(int reg, int pre, int post) {
    if (reg != 15 && m_.special >> reg & 1) fail(Verdict::NotNow);
    const auto at = static_cast<Address>(word(whole(reg)) + static_cast<std::uint32_t>(pre));
    if (pre != 0 || post != 0) set_whole(reg, {static_cast<std::uint16_t>(at + post), 0});
    if (reg == 15) check_stack(at);
    return at;
}

AffineDomain::Address AffineDomain::indexed(int reg, int index) {
    if (m_.special >> reg & 1) fail(Verdict::NotNow);
    return static_cast<Address>(word(whole(reg)) + word(whole(index)));
}

AffineDomain::Address AffineDomain::displaced(int reg, std::uint16_t literal, bool perhaps_stack) {
    const auto at = static_cast<Address>(word(whole(reg)) + literal);
    if (perhaps_stack && reg == 15) check_stack(at);
    return at;
}

/// One byte of a word whose other byte stays put.
AffineDomain::Value AffineDomain::half(Value word, bool high) {
    const int shift = high ? 8 : 0;
    if (word.step == 0) return {word.v >> shift & 0xFF, 0};
    if (high) fail(Verdict::NotNow);
    hold(word.v & 0xFF, word.step, 0, 0xFF);
    return {word.v & 0xFF, word.step};
}

AffineDomain::Value AffineDomain::joined(Value old, Value byte, bool high) {
    if (high) return {(old.v & 0xFF) | static_cast<std::int32_t>(word(byte)) << 8, half(old, false).step};
    if (old.step != 0) half(old, false);  // its upper byte must stay
    return {(old.v & 0xFF00) | byte.v, byte.step};
}

AffineDomain::Value AffineDomain::load(Address at, bool byte) {
    const auto even = static_cast<Address>(at & 0xFFFE);
    if (!byte && even != at) fail(Verdict::NotNow);
    Value word;
    if (is_ram(even)) {
        word = read_cell(even);
    } else if (even < kRamStart) {
        // A register: constant until the next event if nothing happens at a read.
        const bool readable = probe_.on ? m_.sfr.quiet(even) : m_.sfr.plain_read(even);
        if (even < kWEnd || !readable) fail(Verdict::NotNow);
        word = {poll(even), 0};
    } else {
        fail(Verdict::NotNow);
    }
    return byte ? half(word, at & 1) : word;
}

/// A register's value, noted as one of the plan's conditions.
std::uint16_t AffineDomain::poll(Address at) {
    const std::uint16_t value = probe_.on ? probed(at, m_.sfr.quiet_read(at)) : m_.sfr.raw(at);
    for (std::size_t i = 0; i < plan_.polled_count; ++i)
        if (plan_.polled[i].address == at) return value;
    if (plan_.polled_count == plan_.polled.size()) fail(Verdict::NotNow);
    plan_.polled[plan_.polled_count++] = {at, value};
    return value;
}

void AffineDomain::store(Address at, bool byte, Value value) {
    const auto even = static_cast<Address>(at & 0xFFFE);
    if ((!byte && even != at) || !is_ram(even)) fail(Verdict::NotNow);
    write_cell(even, byte ? joined(read_cell(even), value, at & 1) : value);
}

// --- flags -----------------------------------------------------------------------------------------------

void AffineDomain::hold(std::int64_t value, std::int64_t step, std::int64_t low, std::int64_t high) {
    if (step > 0) bound_ = std::min(bound_, static_cast<std::uint64_t>((high - value) / step));
    if (step < 0) bound_ = std::min(bound_, static_cast<std::uint64_t>((value - low) / -step));
}

bool AffineDomain::known(const Flag& flag) {
    if (!flag.known) fail(Verdict::NotNow);  // set before the loop's head
    return flag.value;
}

AffineDomain::Value AffineDomain::moved(bool byte, Value result) {
    const auto all = static_cast<std::int32_t>(ones(byte)), half_way = static_cast<std::int32_t>(top(byte));
    const bool negative = result.v >= half_way;
    hold(result.v, result.step, negative ? half_way : 0, negative ? all : half_way - 1);
    if (result.v != 0)
        hold(result.v, result.step, 1, all);
    else if (result.step != 0)
        bound_ = 0;
    n_ = {true, negative};
    z_ = {true, result.v == 0};
    return result;
}

AffineDomain::Value AffineDomain::add(bool byte, bool sticky, Value a, Value b, bool carry) {
    const auto half_way = static_cast<std::int32_t>(top(byte));
    const std::int32_t width = 2 * half_way;
    const std::int32_t sum = a.v + b.v + (carry ? 1 : 0);
    const std::int32_t step = a.step + b.step;
    const std::int32_t base = sum >= width ? width : 0;
    hold(sum, step, base, base + width - 1);
    const Value result = {sum - base, step};
    for (const Value& operand : {a, b}) {  // the signs make OV
        const bool negative = operand.v >= half_way;
        hold(operand.v, operand.step, negative ? half_way : 0, negative ? width - 1 : half_way - 1);
    }
    const bool z_before = !sticky || z();
    moved(byte, result);
    z_.value = z_.value && z_before;
    set_c(base != 0);
    const bool sign_a = a.v >= half_way, sign_b = b.v >= half_way, sign_r = result.v >= half_way;
    ov_ = {true, sign_a == sign_b && sign_r != sign_a};
    trace_.boundaries.back().sum = {true, byte, carry, {a.v, a.step}, {b.v, b.step}};
    dc_ = {true, dc_of(trace_.boundaries.back().sum, 0)};
    return result;
}

}  // namespace puckloop::dspic
