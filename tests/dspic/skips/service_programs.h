#pragma once
// Programs that wait in loops under two interrupts whose routines count, compare and copy, and what disturbs
// them: drawn from a seed.

#include "base/random.h"
#include "tests/dspic/skips/skipping.h"

namespace puckloop::dspic::test {

inline constexpr int kT2 = 6;
inline constexpr std::uint16_t kCounters = 0x0C10;   ///< eight words that routines count in and compare with
inline constexpr std::uint16_t kConverted = 0x0280;  ///< eight registers that change with time

/// Two sources of interrupts, and changes from outside, at instants of their own.
struct Disturbances {
    struct Beat {
        Disturbances* all = nullptr;
        int irq = 0;
        Cycle period = 0;
        EventQueue::Slot slot = 0;
    };
    Rig& rig;
    RandomStream random;
    Beat beats[2];
    EventQueue::Slot change;
    Cycle drift_period;
    bool jitters;

    Disturbances(Rig& owner, std::uint64_t seed)
        : rig(owner),
          random(seed, "disturbances"),
          change(owner.events.add(this, &disturb)),
          drift_period(53 + random.below(4000)),
          jitters(random.below(4) == 0) {
        for (Beat& beat : beats) {
            beat = {this, &beat == beats ? kT1 : kT2, 150 + random.below(1500),
                    owner.events.add(&beat, &fire)};
            owner.events.schedule(beat.slot, beat.period);
            if (!jitters && random.below(2))
                owner.events.set_steady(beat.slot, {beat.irq, beat.period, &pass});
        }
        owner.events.schedule(change, 5000);
        for (std::uint16_t i = 0; i < 8; ++i) {
            const auto address = static_cast<std::uint16_t>(kConverted + 2 * i);
            owner.sfr.hook(address, this, &read_drifting, nullptr);
            owner.sfr.set_plain_kind(address, SfrSpace::Plain::kConverter);
        }
    }
    static void fire(void* self, Cycle due) {
        Beat& beat = *static_cast<Beat*>(self);
        beat.all->rig.interrupts.raise(beat.irq, due);
        const Cycle more = beat.all->jitters ? beat.all->random.below(90) : 0;
        beat.all->rig.events.schedule(beat.slot, due + beat.period + more);
    }
    static void pass(void* self, std::uint64_t times) {
        Beat& beat = *static_cast<Beat*>(self);
        EventQueue& events = beat.all->rig.events;
        events.schedule(beat.slot, events.due(beat.slot) + times * beat.period);
    }
    static void disturb(void* self, Cycle due) {
        auto& d = *static_cast<Disturbances*>(self);
        const auto number = static_cast<std::uint16_t>(d.random.below(0x10000));
        switch (d.random.below(5)) {
        case 0:
            d.rig.sfr.raw(kPolled) ^= 1;
            break;
        case 1:
            d.rig.sfr.raw(kRefreshed) ^= 2;
            break;
        case 2:
            d.rig.core.ram()[(kCounters - 0x0800) / 2 + number % 8] = number & 0x8000 ? number : number % 40;
            break;
        case 3:
            d.rig.core.ram()[(0x0C00 - 0x0800) / 2 + number % 2] ^= 1;
            break;
        default:
            break;
        }
        d.rig.events.schedule(d.change, due + 1 + d.random.below(60'000));
    }
    void drift() {
        const Cycle period = rig.core.cycle_counter() / drift_period;
        for (std::uint16_t i = 0; i < 8; ++i)
            rig.sfr.raw(static_cast<std::uint16_t>(kConverted + 2 * i)) =
                static_cast<std::uint16_t>((period + i) * 40503u);
        rig.sfr.plain().until[SfrSpace::Plain::kConverter] = (period + 1) * drift_period;
    }
    static std::uint16_t read_drifting(void* owner, std::uint16_t address) {
        auto& d = *static_cast<Disturbances*>(owner);
        d.drift();
        return d.rig.sfr.raw(address);
    }
};

class Writer {
  public:
    explicit Writer(RandomStream& random) : random_(random) {}

    /// Waits for somebody, or counts, in registers or in a frame, with a compare at the end.
    std::string loop() {
        std::string text = "again:  mov #0x1B00, w14\n        clr w4\n        clr w5\n        clr w7\n";
        if (random_.below(2)) text += "        mov #" + number(0x10000) + ", w4\n";
        text += "        mov w4, [w14+2]\n        mov w5, [w14+4]\nwait:\n";
        if (random_.below(2)) text += "        add w2, #" + number(4) + ", w3\n        sub w3, #1, [w15]\n";
        text += pick({"", "", "        inc w7, w7\n",
                      "        mov [w14+2], w0\n        mov [w14+4], w1\n        add w0, #1, w0\n"
                      "        addc w1, #0, w1\n        mov w0, [w14+2]\n        mov w1, [w14+4]\n",
                      "        add w4, #3, w4\n        addc w5, #0, w5\n",
                      "        sub w4, #5, w4\n        mov w4, w6\n"});
        text +=
            pick({"        mov 0x0C00, w0\n        cp0 w0\n        bra nz, done\n        bra wait\n",
                  "        rcall look\n        cp0.b w0\n        bra nz, done\n        bra wait\n",
                  "        btsc 0x0d8, #0\n        bra done\n        nop\n        bra wait\n",
                  "        mov #0x0C02, w1\n        mov [w1], w0\n        cp w0, #0\n        bra z, wait\n",
                  "        mov [w14+2], w2\n        mov [w14+4], w3\n        mov #0x0200, w0\n"
                  "        mov #1, w1\n        sub w2, w0, [w15]\n        subb w3, w1, [w15]\n        bra "
                  "le, wait\n",
                  "        mov #5000, w1\n        cp w7, w1\n        bra nc, wait\n"});
        return text + "done:   inc w12, w12\n        bra again\n" +
               "look:   lnk #2\n        mov w1, [w14]\n        mov.b 0x0d8, wreg\n        ulnk\n        "
               "return\n";
    }
    std::string routine(const std::string& name, const std::string& flag) {
        std::string text =
            name + ":\n        push 0x36\n        push.d w0\n        push.d w2\n        push.d w4\n" +
            "        push 0x34\n        clr w0\n        mov w0, 0x34\n        lnk #" + number(4, 2) + "\n";
        const auto lines = 1 + random_.below(7);
        for (std::uint64_t i = 0; i < lines; ++i)
            text += step(name + std::to_string(i));
        return text + "        bclr " + flag + "\n        ulnk\n        pop 0x34\n        pop.d w4\n" +
               "        pop.d w2\n        pop.d w0\n        pop 0x36\n        retfie\n";
    }

  private:
    std::string pick(std::initializer_list<const char*> choice) {
        return choice.begin()[random_.below(choice.size())];
    }
    std::string number(std::uint64_t below, std::uint64_t times = 1) {
        return std::to_string(times * random_.below(below));
    }
    std::string counter() { return std::to_string(kCounters + 2 * random_.below(8)); }

    /// A few instructions, `label` being theirs.
    std::string step(const std::string& label) {
        const std::string word = counter(), other = counter();
        switch (random_.below(19)) {
        case 0:  // counts
            return "        mov " + word + ", w0\n        " + pick({"inc", "dec", "inc2", "dec2"}) +
                   " w0, w0\n        mov w0, " + word + "\n";
        case 1:  // counts in 32 bits
            return "        mov " + word + ", w0\n        mov " + other +
                   ", w1\n        add w0, #1, w0\n        addc w1, #0, w1\n        mov w0, " + word +
                   "\n        mov w1, " + other + "\n";
        case 2:  // counts round
        case 3:
            return "        inc " + word + "\n        mov " + word + ", w0\n        mov #" + number(40) +
                   ", w1\n        sub w0, w1, [w15]\n        bra " +
                   pick({"lt", "le", "leu", "nc", "nz", "n", "nov"}) + ", " + label + "\n        clr " +
                   word + "\n" + label + ":\n";
        case 4:  // a branch on two counters
            return "        mov " + word + ", w0\n        mov " + other +
                   ", w1\n        cp w0, w1\n        bra " + pick({"ge", "gt", "gtu", "c", "z", "ov", "nn"}) +
                   ", " + label + "\n        inc " + word + "\n" + label + ":\n";
        case 5:  // copies bytes to a place that a counter decides
            return "        mov " + word + ", w0\n        and w0, #15, w0\n        sl w0, #3, w0\n" +
                   "        mov #0x0D00, w1\n        add w0, w1, w3\n        mov #" +
                   pick({"0x0280", "0x0C10", "0x0E01"}) + ", w1\n        mov #" + number(9) +
                   ", w2\n        bra " + label + "b\n" + label +
                   ":  mov.b [w1++], [w3++]\n        dec w2, w2\n" + label + "b: cp0 w2\n        bra nz, " +
                   label + "\n";
        case 6:
            return "        mov " + word +
                   ", w4\n        mov w4, [w14]\n        mov [w14], w5\n        mov w5, " + other + "\n";
        case 7:  // bytes
            return "        mov.b " + word + ", wreg\n        " +
                   pick({"inc.b w0, w0", "add.b #3, w0", "com.b w0, w0", "swap.b w0", "nop"}) +
                   "\n        mov.b wreg, " + other + "\n";
        case 8:  // exchanges two words
            return "        mov " + word + ", w0\n        mov " + other + ", w1\n        mov w0, " + other +
                   "\n        mov w1, " + word + "\n";
        case 9:
            return "        mov " + word + ", w0\n        cp0 w0\n        bra " +
                   pick({"le", "z", "nz", "lt", "ge"}) + ", " + label + "\n        dec " + word + "\n" +
                   label + ":\n";
        case 10:
            return "        cp0 " + word + "\n        bra " + pick({"n", "z", "gt"}) + ", " + label +
                   "\n        com " + other + "\n" + label + ":\n";
        case 11:
            return "        mov #2, w0\n        mov w0, 0x0da\n";
        case 12:  // leaves something in a register
            return "        " + pick({"inc w10, w10", "mov w0, w11", "mov 0x0280, w10", "mov.b #7, w11"}) +
                   "\n";
        case 13:
            return "        btsc " + word + ", #" + number(8) + "\n        inc " + other + "\n";
        case 14:
            return "        mov 0x0282, w0\n        mov w0, " + word + "\n        mov.b 0x0285, wreg\n";
        case 15:
            return "        mov #" + word + ", w1\n        mov [w1], w2\n        " +
                   pick({"add w2, #7, [w1]", "sub w2, #3, [w1]", "subr w2, #9, [w1]", "ior w2, #1, [w1]"}) +
                   "\n";
        case 16:
            return "        mov " + word + "\n        bra " + pick({"nz", "n", "z"}) + ", " + label +
                   "\n        setm " + other + "\n" + label + ":\n";
        case 17:  // what no path can hold
            return "        " +
                   pick({"mov 0x0d8, w0", "bset 0x0d8, #4", "clrwdt", "repeat #2\n        nop",
                         "mov w15, 0x0E40"}) +
                   "\n";
        default:
            return "        mov w6, " + word + "\n        mov w15, w0\n        mov w0, " + other + "\n";
        }
    }
    RandomStream& random_;
};

/// A whole program; routines "isr" of T1, and "other".
inline std::string waiting_program(const DeviceInfo& device, RandomStream& random) {
    Writer writer(random);
    const auto enables = std::to_string(device.iec);
    std::string source = kHead + "        bset " + enables + ", #3\n        bset " + enables +
                         ", #6\n        mov #0x1C00, w15\n        clr 0x0C00\n        clr 0x0C02\n";
    for (int i = 0; i < 8; ++i)
        source += "        mov #" + std::to_string(random.below(random.below(2) ? 60 : 0x10000)) +
                  ", w0\n        mov w0, " + std::to_string(kCounters + 2 * i) + "\n";
    for (const int priorities : {0, 2})  // of T1, and of the other one
        if (random.below(2))
            source += "        mov #" + std::to_string(0x1111 * (1 + random.below(7))) +
                      ", w0\n        mov w0, " + std::to_string(device.ipc + priorities) + "\n";
    source += writer.loop() + writer.routine("isr", "0x84, #3") + writer.routine("other", "0x84, #6");
    return source;
}

}  // namespace puckloop::dspic::test
