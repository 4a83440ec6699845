#pragma once
// Looks in the bytes of serial lines, as they pass, for those that the scenario expects.

#include "cosim/trace/trace.h"
#include "run/expectations/byte_match.h"
#include "scenarios/description/expectation.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

class LineWatch final : public cosim::TraceSink {
  public:
    /// What was seen so far for one table.
    struct Watch {
        std::size_t index = 0;
        std::optional<std::size_t> link{};
        ByteMatch matches[2]{};  ///< of each direction
        std::optional<double> seen{};
        std::uint64_t came = 0;  ///< bytes that were looked at
        std::string last{};      ///< of these, at most kShown
    };
    static constexpr std::size_t kShown = 12;

    /// Of all kinds; those of serial lines are watched. `expected` outlives this.
    explicit LineWatch(const std::vector<scenarios::Expectation>& expected);

    bool watches() const { return !watches_.empty(); }
    /// When the last byte of the first match arrived within the time that the table states, s; by the table's
    /// index in `expected`.
    std::optional<double> seen_at(std::size_t index) const;
    /// What came in place of what was expected, for people: "of 312 bytes the last were 4E 00".
    std::string what_came(std::size_t index) const;

    /// For a run that goes back: what was seen until an instant, and that this is all again.
    const std::vector<Watch>& seen() const { return watches_; }
    void go_back(std::vector<Watch> seen) { watches_ = std::move(seen); }

    void begin(const std::vector<cosim::LinkSpec>& links) override;
    void record(const cosim::TraceRecord& record) override;

  private:
    const Watch* watch_of(std::size_t index) const;

    const std::vector<scenarios::Expectation>& expected_;
    std::vector<cosim::LinkSpec> links_;
    std::vector<Watch> watches_;
};

}  // namespace puckloop::tools
