#pragma once
// IRcom: words of one byte as light that is switched on and off, between e-pucks and between an e-puck and a
// TAM. Source: TAM fact sheet section 8, e-puck fact sheet 3.10.
//
// A word is twelve symbols: two MARKs to start, eight data bits, most significant first (0 is MARK, 1 is
// SPACE), two bits of check, high bit first, which make the number of ones plus the check a multiple of four.
// A MARK is ten half periods of some 260 us, a SPACE five of some 520 us: 2.6 ms either way, a word 31.2 ms.
//
// Each half period ends with a toggle. The light is off before the first toggle and is switched off with the
// last one; so a word with an odd number of half periods lacks its last edge.

#include "cosim/core/time.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::protocols {

inline constexpr int kIrcomSymbols = 12;
inline constexpr int kIrcomMarkHalves = 10, kIrcomSpaceHalves = 5;

/// Half periods of a sender.
struct IrcomTiming {
    cosim::Time mark = 260 * cosim::kMicrosecond;
    cosim::Time space = 520 * cosim::kMicrosecond;
};
/// ARGoS' e-puck firmware: timer 1 at 1:8, 481 and 961 counts of 14.7456 MHz.
inline constexpr IrcomTiming kIrcomEpuck{260'959'201, 521'375'868};
/// The TAM's firmware: timer 2 at 1:64, whose prescaler runs on. 65 and 130 ticks of 4 us, and two more that
/// pass before the interrupt, some 180 cycles after the overflow, has written the counter.
inline constexpr IrcomTiming kIrcomTam{268 * cosim::kMicrosecond, 528 * cosim::kMicrosecond};

struct IrcomEdge {
    cosim::Time time = 0;
    bool lit = false;  ///< the light goes on
    friend bool operator==(const IrcomEdge&, const IrcomEdge&) = default;
};

/// Check of a data byte, 0..3.
int ircom_check(std::uint8_t word);
/// The twelve symbols, the first one in bit 11, 1 is SPACE.
std::uint16_t ircom_symbols(std::uint8_t word);
/// "MMSMSMMSMSMM": any twelve symbols as text.
std::string ircom_text(std::uint16_t symbols);
/// Edges of any twelve symbols, the first at time 0; its half period lies before that.
std::vector<IrcomEdge> ircom_edges(std::uint16_t symbols, const IrcomTiming& timing = {});

enum class IrcomFault : std::uint8_t {
    None,
    Short,    ///< ended within a symbol, or after fewer than twelve
    Long,     ///< more than twelve symbols
    Symbol,   ///< the number of half periods of a kind is no multiple of ten or five
    Gap,      ///< an interval that is neither kind
    Start,    ///< does not begin with two MARKs
    Check,    ///< number of ones and check do not fit
    NoLight,  ///< the first edge is not a rise
};
std::string_view name_of(IrcomFault fault);

struct IrcomReading {
    IrcomFault fault = IrcomFault::None;
    std::uint8_t word = 0;      ///< valid without fault, or with Check
    std::uint16_t symbols = 0;  ///< likewise, and with Start
    int check = 0;              ///< as received
    int edge = 0;               ///< with Gap and Symbol: the edge, from 0, at which it was noticed
    int edges = 0;              ///< how many there were, short pulses left out
    cosim::Time start = 0;      ///< first edge
    cosim::Time end = 0;        ///< last edge
    bool ok() const { return fault == IrcomFault::None; }
};
/// One line: the word, or what is wrong and where.
std::string explain(const IrcomReading& reading);

/// Reads the edges of one word, in order. Half periods may be off by a quarter (half of that at a symbol's
/// border does no harm); pulses under 40 us are left out.
IrcomReading read_ircom(std::span<const IrcomEdge> edges);

/// Cuts a light's edges into words: a word has ended when nothing has changed for 1.5 ms.
class IrcomReader {
  public:
    static constexpr cosim::Time kRest = 1500 * cosim::kMicrosecond;

    /// Edges in time order. The word that ended before this edge, if one did.
    std::optional<IrcomReading> edge(cosim::Time now, bool lit);
    /// The word that has ended by now, if there is one that was not handed out.
    std::optional<IrcomReading> until(cosim::Time now);

    template <class Archive>
    void state(Archive& archive) {
        archive(times_, lit_first_);
    }

  private:
    std::vector<cosim::Time> times_;  ///< of the word under way; the light alternates
    bool lit_first_ = false;
};

}  // namespace puckloop::protocols
