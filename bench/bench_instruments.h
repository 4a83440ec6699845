#pragma once
// What looks at the bench's chip while it runs: `--trace`, `--watch`, `--stats` and the files made of it.

#include "bench/targets/target.h"
#include "debug/debug_chip.h"
#include "debug/instruction_trace.h"
#include "debug/instruments.h"
#include "debug/places.h"
#include "debug/profile/profile.h"
#include "emu/image/image.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::exec {

/// As the command line gave them.
struct InstrumentOptions {
    std::string trace;                      ///< file, or empty
    std::vector<std::string> trace_ranges;  ///< SYMBOL or 0xFIRST..0xLAST
    double trace_from = 0.0, trace_to = 1e300;
    std::vector<std::string> watches;  ///< SYMBOL or 0xADDRESS, perhaps :BYTES, perhaps /r, /w or /rw
    bool stats = false;
    std::string callgrind, coverage;  ///< files, or empty
    std::string sources;              ///< folder of the source files, for coverage

    bool profiles() const { return stats || !callgrind.empty() || !coverage.empty(); }
    bool any() const { return !trace.empty() || !watches.empty() || profiles(); }
};

class BenchInstruments {
  public:
    /// The image is the one that `target` read; both stay. Throws InputError: a name that the image does not
    /// have; RunError: a file that cannot be written.
    BenchInstruments(const InstrumentOptions& options, Target& target, const image::Image& image);
    ~BenchInstruments();
    BenchInstruments(const BenchInstruments&) = delete;
    BenchInstruments& operator=(const BenchInstruments&) = delete;

    /// "watch NAME: write of 0x0123 by 0x001234 main+0x12", once one has ended the run.
    const std::string& watched() const;
    /// The run is over: files are written. Throws RunError.
    void finish();
    /// For a person; empty without --stats.
    std::string text() const;
    /// That the stack has grown over variables; empty: it has not, or nobody looked (--stats).
    std::string warning() const;
    /// A JSON object; empty without --stats.
    std::string json() const;

  private:
    class Watches;

    InstrumentOptions options_;
    std::string image_;
    std::unique_ptr<debug::DebugChip> chip_;
    debug::Places places_;
    debug::Variables variables_;
    std::optional<debug::InstructionTrace> trace_;
    std::optional<debug::Profile> profile_;
    std::unique_ptr<Watches> watches_;
    debug::Instruments instruments_;
};

}  // namespace puckloop::exec
