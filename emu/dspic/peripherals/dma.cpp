#include "emu/dspic/peripherals/dma.h"

#include "emu/dspic/devices/register_bits.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

enum Offset : int { kCon = 0, kReq = 2, kSta = 4, kStb = 6, kPad = 8, kCnt = 10, kStep = 12 };
constexpr RegisterBits kDMAxCON{"DMA?CON"};
constexpr RegisterBits kDMAxREQ{"DMA?REQ"};
constexpr unsigned kFixedAddress = 1;        // AMODE
constexpr std::uint16_t kOneShot = bit(0);   // MODE
constexpr std::uint16_t kPingPong = bit(1);  // MODE

constexpr Cycle kLatency = 2;

}  // namespace

Dma::Dma(const Surroundings& around, const Setup& setup, std::span<std::uint16_t> ram)
    : around_(around), setup_(setup), ram_(ram), slot_(around.events.add(this, due)) {
    for (int number = 0; number < kChannels; ++number) {
        const auto at = [&](int offset) {
            return static_cast<std::uint16_t>(setup_.con + kStep * number + offset);
        };
        around_.sfr.hook(at(kCon), this, nullptr, write_con);
        around_.sfr.hook(at(kReq), this, nullptr, write_req);
        for (const int offset : {kSta, kStb, kPad, kCnt})
            around_.sfr.claim(at(offset));
    }
    around_.sfr.claim(setup_.cs0);
    for (const int offset : {2, 4})  // DMACS1, DSADR: read only
        around_.sfr.hook(static_cast<std::uint16_t>(setup_.cs0 + offset), this, nullptr, write_nothing);
}

void Dma::reset() {
    channels_ = {};
    pending_ = 0;
    around_.events.cancel(slot_);
    listen();
}

std::uint16_t& Dma::reg(int number, int offset) const {
    return around_.sfr.raw(static_cast<std::uint16_t>(setup_.con + kStep * number + offset));
}

// The enabled channels' sources are worth a call.
void Dma::listen() {
    std::array<std::uint64_t, 2> sources{};
    for (int number = 0; number < kChannels; ++number) {
        if (!(reg(number, kCon) & kDMAxCON["CHEN"])) continue;
        const unsigned irq = kDMAxREQ["IRQSEL"].of(reg(number, kReq));
        sources[irq / 64] |= std::uint64_t{1} << (irq % 64);
    }
    around_.interrupts.set_tap(this, requested, sources);
}

void Dma::requested(void* owner, int irq, Cycle at) {
    Dma& self = *static_cast<Dma*>(owner);
    for (int number = 0; number < kChannels; ++number)
        if ((self.reg(number, kCon) & kDMAxCON["CHEN"]) &&
            kDMAxREQ["IRQSEL"].of(self.reg(number, kReq)) == static_cast<unsigned>(irq) &&
            std::ranges::find(self.blocks_, self.reg(number, kPad)) == self.blocks_.end())
            self.pending_ |= static_cast<std::uint8_t>(bit(number));
    if (self.pending_) self.around_.events.schedule(self.slot_, at + kLatency);
}

void Dma::block(int irq, std::uint16_t pad, unsigned offset, std::span<std::uint16_t> words, Cycle at) {
    for (int number = 0; number < kChannels; ++number) {
        const std::uint16_t con = reg(number, kCon);
        if (!(con & kDMAxCON["CHEN"]) || reg(number, kPad) != pad ||
            kDMAxREQ["IRQSEL"].of(reg(number, kReq)) != static_cast<unsigned>(irq))
            continue;
        Channel& channel = channels_[static_cast<std::size_t>(number)];
        const unsigned block = reg(number, kCnt) + 1u;
        const std::size_t first = (reg(number, channel.second ? kStb : kSta) + offset) / 2u;
        for (std::size_t i = 0; i < words.size() && i < block; ++i) {
            std::uint16_t& word = ram_[(first + i) % ram_.size()];
            (con & kDMAxCON["DIR"] ? words[i] : word) = con & kDMAxCON["DIR"] ? word : words[i];
            ++channel.done;
            if ((con & kDMAxCON["HALF"]) && channel.done == block / 2)
                around_.interrupts.raise(setup_.irqs[static_cast<std::size_t>(number)], at);
        }
        if (channel.done >= block) block_done(number, at);
        return;
    }
}

void Dma::due(void* owner, Cycle due) {
    Dma& self = *static_cast<Dma*>(owner);
    const std::uint8_t asked = self.pending_;
    self.pending_ = 0;
    for (int number = 0; number < kChannels; ++number)
        if (asked >> number & 1) self.transfer(number, due);
}

/// Between the peripheral's register and RAM.
void Dma::move(int number) {
    const std::uint16_t con = reg(number, kCon);
    const std::uint16_t pad = reg(number, kPad);
    const Channel& channel = channels_[static_cast<std::size_t>(number)];
    const unsigned start = reg(number, channel.second ? kStb : kSta);
    const auto offset = static_cast<std::uint16_t>((start + channel.offset) % (2 * ram_.size()));
    std::uint16_t& word = ram_[offset / 2u];
    const bool byte = con & kDMAxCON["SIZE"];
    const int shift = byte && (offset & 1) ? 8 : 0;
    const auto lane = static_cast<std::uint16_t>(byte ? 0xFF << shift : 0xFFFF);
    const std::uint16_t mask = !byte ? 0xFFFF : pad & 1 ? 0xFF00 : 0x00FF;
    const auto even = static_cast<std::uint16_t>(pad & 0xFFFE);
    const int pad_shift = byte && (pad & 1) ? 8 : 0;
    if (con & kDMAxCON["DIR"]) {
        const auto value = static_cast<std::uint16_t>((word & lane) >> shift << pad_shift);
        around_.sfr.write(even, value, mask);
    } else {
        const auto value = static_cast<std::uint16_t>((around_.sfr.read(even) & mask) >> pad_shift);
        word = static_cast<std::uint16_t>((word & ~lane) | (value << shift & lane));
        if (con & kDMAxCON["NULLW"]) around_.sfr.write(even, 0, mask);
    }
    around_.sfr.raw(static_cast<std::uint16_t>(setup_.cs0 + 4)) =
        static_cast<std::uint16_t>(setup_.ram + offset);
}

void Dma::transfer(int number, Cycle at) {
    const std::uint16_t con = reg(number, kCon);
    if (!(con & kDMAxCON["CHEN"])) return;
    assign(reg(number, kReq), kDMAxREQ["FORCE"], false);
    if (reg(number, kPad) < 2 * SfrSpace::kWords) move(number);
    std::uint16_t& cs1 = around_.sfr.raw(static_cast<std::uint16_t>(setup_.cs0 + 2));
    cs1 = static_cast<std::uint16_t>((cs1 & 0x00FFu) | static_cast<unsigned>(number) << 8);
    Channel& channel = channels_[static_cast<std::size_t>(number)];
    if (kDMAxCON["AMODE"].of(con) != kFixedAddress)
        channel.offset = static_cast<std::uint16_t>(channel.offset + (con & kDMAxCON["SIZE"] ? 1 : 2));
    ++channel.done;
    const unsigned block = reg(number, kCnt) + 1u;
    if ((con & kDMAxCON["HALF"]) && channel.done == block / 2)
        around_.interrupts.raise(setup_.irqs[static_cast<std::size_t>(number)], at);
    if (channel.done >= block) block_done(number, at);
}

void Dma::block_done(int number, Cycle at) {
    std::uint16_t& con = reg(number, kCon);
    Channel& channel = channels_[static_cast<std::size_t>(number)];
    channel.done = 0;
    channel.offset = 0;
    const bool last_of_pair = !(con & kPingPong) || channel.second;
    if (con & kPingPong) {
        channel.second = !channel.second;
        std::uint16_t& cs1 = around_.sfr.raw(static_cast<std::uint16_t>(setup_.cs0 + 2));
        assign(cs1, bit(number), channel.second);
    }
    if ((con & kOneShot) && last_of_pair) {
        assign(con, kDMAxCON["CHEN"], false);
        listen();
    }
    if (!(con & kDMAxCON["HALF"]))
        around_.interrupts.raise(setup_.irqs[static_cast<std::size_t>(number)], at);
}

void Dma::write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Dma& self = *static_cast<Dma*>(owner);
    const bool was_on = self.around_.sfr.raw(address) & kDMAxCON["CHEN"];
    self.around_.sfr.store(address, value, mask);
    const int number = (address - self.setup_.con) / kStep;
    if (!was_on && (self.around_.sfr.raw(address) & kDMAxCON["CHEN"])) {
        self.channels_[static_cast<std::size_t>(number)] = {};
        assign(self.around_.sfr.raw(static_cast<std::uint16_t>(self.setup_.cs0 + 2)), bit(number), false);
    }
    self.listen();
}

void Dma::write_req(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Dma& self = *static_cast<Dma*>(owner);
    const bool forced = self.around_.sfr.raw(address) & kDMAxREQ["FORCE"];
    self.around_.sfr.store(address, value, mask);
    const int number = (address - self.setup_.con) / kStep;
    if (forced) self.around_.sfr.raw(address) |= kDMAxREQ["FORCE"];  // software cannot take it back
    if (!forced && (self.around_.sfr.raw(address) & kDMAxREQ["FORCE"]) &&
        (self.reg(number, kCon) & kDMAxCON["CHEN"])) {
        self.pending_ |= static_cast<std::uint8_t>(bit(number));
        self.around_.events.schedule(self.slot_, self.around_.now + kLatency);
    }
    self.listen();
}

void Dma::write_nothing(void*, std::uint16_t, std::uint16_t, std::uint16_t) {}

}  // namespace puckloop::dspic
