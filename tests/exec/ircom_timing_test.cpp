// Where the time of an IRcom exchange goes, to the cycle: docs/ircom.md. Costs of handlers are counted by
// hand from the image's disassembly and the programmer's reference, not taken from the emulator.

#include "tests/exec/rig.h"

#include <catch2/catch.hpp>

#include <map>
#include <vector>

using namespace puckloop;
using dspic::Cycle;
using exec::Rig;

namespace {

// From the flag to the handler's first instruction are five cycles, of which the interrupted instruction uses
// one, or a second one: an interrupt takes four cycles before its handler, or three.
constexpr Cycle kEntry = 4;
constexpr Cycle kRetfie = 3;

// The word has been sent, and the loop that then counts to 50 000 is over.
constexpr std::uint32_t kSpinBegins = 0x200C, kSpinEnds = 0x2030;
// Five cycles up to the first comparison; 50 000 times 8 for it and 7 for counting; 7 to leave.
constexpr Cycle kSpin = 5 + 50'000 * (8 + 7) + 7;

constexpr Cycle kAdcSample = 162;    // copies eight readings byte by byte
constexpr Cycle kAdcWindow = 172;    // the 32nd: swaps the two buffers
constexpr Cycle kAgenda = 35;        // T2: an empty list
constexpr Cycle kTickIdle = 76;      // T1: no window is complete
constexpr Cycle kTickWindow = 7224;  // T1: largest amplitude of eight sensors in a window of 32

enum Handler { Adc, T2, T1 };

struct Mark {
    Handler handler;
    bool entry;  ///< its first instruction, not its RETFIE
};
const std::map<std::uint32_t, Mark> kMarks{{0x22C, {Adc, true}}, {0x294, {Adc, false}}, {0x3AE, {T2, true}},
                                           {0x418, {T2, false}}, {0x1D0, {T1, true}},   {0x214, {T1, false}}};

/// Runs of each handler by the cycles that it took itself, without handlers that interrupted it.
class Account {
  public:
    void at(const Mark& mark, Cycle cycle) {
        if (mark.entry) return open_.push_back({mark.handler, cycle, 0});
        const Open over = open_.back();
        open_.pop_back();
        const Cycle whole = cycle + kRetfie - over.since;
        if (!open_.empty()) open_.back().inner += whole + kEntry;
        ++runs[over.handler][whole - over.inner];
        total += whole - over.inner + kEntry;
        ++interrupts;
    }
    /// Runs that took `cycles`, or up to `less` fewer: as many as came in between with an entry of three.
    int count(Handler handler, Cycle cycles, Cycle less) {
        int all = 0;
        for (const auto& [own, times] : runs[handler])
            if (own <= cycles && own + less >= cycles) all += times;
        return all;
    }
    int count(Handler handler) { return count(handler, kTickWindow, kTickWindow); }

    std::map<Handler, std::map<Cycle, int>> runs;
    Cycle total = 0, interrupts = 0;

  private:
    struct Open {
        Handler handler;
        Cycle since, inner;
    };
    std::vector<Open> open_;
};

/// Ready for frames, in the ring LEDs' idle loop's session.
void begin_session(Rig& rig) {
    rig.run_to(41);
    rig.send(2, {1});
    rig.run_for(0.2);
    rig.send(2, {0, 0, 0, 0});
    rig.run_for(0.1);
    rig.take(2);
}

}  // namespace

TEST_CASE("epuck_firmware.hex: every cycle between an IRcom word and its answer is accounted for") {
    const auto image = exec::real_image("epuck_firmware.hex");
    if (!image) return;
    Rig rig("pic", *image);
    begin_session(rig);
    for (const auto& [pc, mark] : kMarks)
        rig.chip().stop_at(pc);
    rig.chip().stop_at(kSpinBegins);
    rig.chip().stop_at(kSpinEnds);
    const double sent = rig.send(2, {0, 0, 0, 0, 0, 0, 0, 0, 1, 0xA5, 'N', 0});
    Account account;
    Cycle begun = 0, ended = 0;
    double word_s = 0, spun_s = 0;
    const cosim::Time until = rig.bench().now() + 150 * cosim::kMillisecond;
    while (rig.bench().run_until(until) == exec::Bench::End::Address) {
        const std::uint32_t pc = rig.chip().pc();
        if (pc == kSpinBegins) {
            begun = rig.chip().cycle();
            word_s = rig.now_s() - sent;
        } else if (pc == kSpinEnds) {
            ended = rig.chip().cycle();
            spun_s = rig.now_s() - sent;
        } else if (begun != 0 && ended == 0) {
            account.at(kMarks.at(pc), rig.chip().cycle());
        }
    }
    REQUIRE(ended > begun);
    // The handlers take what counting by hand gives, and nothing else takes any time.
    CHECK(account.runs[Adc] == std::map<Cycle, int>{{kAdcSample, 988}, {kAdcWindow, 31}});
    CHECK(account.count(T2) == account.count(T2, kAgenda, 1));
    const int idle = account.count(T1, kTickIdle, 1), windows = account.count(T1, kTickWindow, 6);
    CHECK(account.count(T1) == idle + windows);
    CHECK(ended - begun <= kSpin + account.total);
    CHECK(ended - begun >= kSpin + account.total - account.interrupts);
    // The converter's rate: eight channels of 15 TAD of 10 cycles. A window is 32 scans.
    const double elapsed = static_cast<double>(ended - begun);
    CHECK(account.count(Adc) == Approx(elapsed / 1200).margin(1));
    CHECK(windows == Approx(elapsed / (32 * 1200)).margin(1));
    // 31.3 ms of word, then 83 ms: 50.9 of counting, the rest interrupts.
    CHECK(word_s == Approx(31.33e-3).epsilon(0.002));
    CHECK(spun_s - word_s == Approx(82.96e-3).epsilon(0.002));
}
