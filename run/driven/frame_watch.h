#pragma once
// What a client sees of the lines of a run: frames that it captures, and those that a step waits for.

#include "base/json.h"
#include "cosim/trace/trace.h"
#include "run/expectations/byte_match.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

/// Keys "link", "from", "kind", "value" and "signal", as the columns of trace.csv; what is absent matches
/// all.
class FrameFilter {
  public:
    FrameFilter() = default;
    /// Throws InputError: an unknown key or link, with what was perhaps meant.
    FrameFilter(const nlohmann::json& keys, const std::vector<cosim::LinkSpec>& links);
    bool matches(const nlohmann::ordered_json& frame) const;
    /// Without looking at what it carries: this may be a frame of the filter.
    bool may_match(std::string_view link, std::string_view from) const;

  private:
    nlohmann::ordered_json keys_;
};

class FrameWatch final : public cosim::TraceSink {
  public:
    static constexpr std::size_t kMostFrames = 1'000'000;

    /// From now on; each call adds a filter.
    void capture(FrameFilter filter) { captured_by_.push_back(std::move(filter)); }
    /// Those captured since the last call. `lost`: so many more did not fit.
    std::vector<nlohmann::ordered_json> take(std::size_t& lost);

    /// Nothing, or what a step waits for: a frame, or a text in the bytes of one direction of a line.
    void wait_for(FrameFilter filter, std::string text = {});
    void wait_for_nothing() { waits_ = false; }
    /// For what was waited for last, as if it had never ended: of a text a part may have been seen.
    void wait_on() { waits_ = true; }
    bool seen() const { return seen_; }
    /// The frame that was waited for; of a text null.
    const nlohmann::ordered_json& found() const { return found_; }

    /// The run goes back to `time`: what was captured from there on comes again, and nothing before.
    void go_back(cosim::Time time);

    void begin(const std::vector<cosim::LinkSpec>& links) override { links_ = links; }
    void record(const cosim::TraceRecord& record) override;

  private:
    std::vector<cosim::LinkSpec> links_;
    std::vector<FrameFilter> captured_by_;
    std::vector<nlohmann::ordered_json> captured_;
    std::size_t lost_ = 0;
    cosim::Time known_ = 0;  ///< what comes before is known already
    bool waits_ = false, seen_ = false;
    FrameFilter wanted_;
    ByteMatch text_;
    nlohmann::ordered_json found_;
};

/// The columns of trace.csv that are not empty, and "time_ps".
nlohmann::ordered_json frame_json(const cosim::TraceRecord& record,
                                  const std::vector<cosim::LinkSpec>& links);

}  // namespace puckloop::tools
