#include "replay/replay.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>
#include <utility>

namespace puckloop::tools {

using cosim::LinkSpec;
using cosim::Message;
using cosim::Time;
using cosim::TraceRow;

namespace {

constexpr Time kStride = cosim::kMillisecond;

/// One of the node's ports and its link.
struct Attached {
    const LinkSpec* link = nullptr;
    cosim::PortIndex port = 0;
    Time flight = 0;
};

class Replay {
  public:
    Replay(cosim::Node& node, const std::vector<LinkSpec>& links, const ReplayOptions& options)
        : node_(node),
          by_port_(node.ports().size()),
          sent_(options.links_with_faults),
          watch_(options.watch),
          wind_up_(options.wind_up.value_or(cosim::kNever)) {
        const auto ports = node.ports();
        for (const LinkSpec& link : links)
            for (const cosim::PortRef* end : {&link.a, &link.b}) {
                if (end->node != node.name()) continue;
                const auto port = std::find_if(ports.begin(), ports.end(),
                                               [&](const cosim::Port& one) { return one.name == end->port; });
                if (port == ports.end()) continue;
                const auto index = static_cast<cosim::PortIndex>(port - ports.begin());
                by_link_[link.name] = {&link, index, flight_time(link)};
                by_port_[index] = by_link_[link.name];
            }
    }

    void take(const TraceRow& row) {
        if (row.time >= now_ + kStride && (inbox_.empty() || inbox_.back().time < row.time))
            advance(row.time);
        last_ = row.time;
        const auto found = by_link_.find(row.link);
        if (found == by_link_.end()) return;
        ++rows_;
        if (row.link != last_link_) result_.links.insert(last_link_ = row.link);
        if (result_.difference) return;
        if (row.from == node_.name())
            sent_.recorded(row);
        else if (!keeps_from_arriving(row.fault))
            inbox_.push_back({row.time, found->second.port, payload_of(row, *found->second.link)});
    }

    void advance(Time until) {
        if (result_.difference) return;
        result_.received += inbox_.size();
        if (watch_ != nullptr && until >= watch_->from) {
            if (now_ < watch_->from) step(watch_->from);
            if (!std::exchange(looked_, true)) watch_->look(now_);
            while (now_ < until) {
                step(std::min(until, watch_->next(now_)));
                watch_->look(now_);
            }
        }
        if (now_ < until) step(until);
        inbox_.clear();
        handed_in_ = 0;
        result_.difference = sent_.check(until);
    }

    ReplayResult end() {
        if (!inbox_.empty() && inbox_.back().time == last_)
            std::erase_if(inbox_, [this](const Message& message) { return message.time == last_; });
        if (last_ > now_) advance(last_);
        if (!result_.difference) result_.difference = sent_.finish(last_);
        result_.equal = sent_.equal();
        result_.until = now_;
        return result_;
    }
    bool done() const { return result_.difference.has_value(); }
    std::uint64_t rows() const { return rows_; }

  private:
    void step(Time until) {
        if (now_ < wind_up_ && until >= wind_up_) {
            step_to(wind_up_);
            node_.wind_up(wind_up_, 0);
        }
        if (now_ < until) step_to(until);
    }

    void step_to(Time until) {
        std::size_t end = handed_in_;
        while (end < inbox_.size() && inbox_[end].time < until)
            ++end;
        outbox_.clear();
        node_.advance(until, std::span(inbox_).subspan(handed_in_, end - handed_in_), outbox_);
        handed_in_ = end;
        now_ = until;
        for (const Message& message : outbox_) {
            const Attached& out = by_port_[message.port];
            if (out.link == nullptr) continue;
            sent_.replayed(row_of(message, out));
        }
    }

    static cosim::Payload payload_of(const TraceRow& row, const LinkSpec& link) {
        const auto* signal = std::get_if<cosim::Signal>(&row.payload);
        if (signal == nullptr) return row.payload;
        const auto& names = link.signal_names;
        if (row.signal.empty() && (names.empty() || signal->id < names.size())) return row.payload;
        const auto found = std::find(names.begin(), names.end(), row.signal);
        if (found == names.end())
            throw InputError("", link.name,
                             fmt::format("the record has a signal '{}'",
                                         row.signal.empty() ? fmt::format("#{}", signal->id) : row.signal),
                             "a record of this scenario");
        return cosim::Signal{static_cast<std::uint16_t>(found - names.begin()), signal->value};
    }

    TraceRow row_of(const Message& message, const Attached& out) const {
        TraceRow row{delivery_time(message, out.flight, out.link->latency),
                     out.link->name,
                     std::string(node_.name()),
                     {},
                     cosim::FaultKind::None,
                     message.payload};
        if (const auto* signal = std::get_if<cosim::Signal>(&message.payload))
            if (signal->id < out.link->signal_names.size()) row.signal = out.link->signal_names[signal->id];
        return row;
    }

    cosim::Node& node_;
    std::map<std::string, Attached> by_link_;
    std::vector<Attached> by_port_;
    SentComparison sent_;
    const ReplayWatch* watch_;
    Time wind_up_;
    bool looked_ = false;
    std::vector<Message> inbox_, outbox_;
    std::size_t handed_in_ = 0;  // of inbox_
    Time now_ = 0, last_ = 0;
    std::uint64_t rows_ = 0;
    std::string last_link_;
    ReplayResult result_;
};

}  // namespace

ReplayResult replay(cosim::Node& node, const std::vector<LinkSpec>& links, const RecordedTrace& record,
                    const ReplayOptions& options) {
    Replay run(node, links, options);
    RecordedTrace::Cursor cursor(record);
    // One row of the node is wanted before a difference counts: the record may be another scenario's.
    const auto refuse = [&](const TraceRow& row, const char* why) {
        throw InputError(record.file().string(), "",
                         fmt::format("the message at {} s {}", cosim::format_seconds(row.time), why),
                         "a record as the run left it");
    };
    std::optional<TraceRow> row = cursor.next();
    while (row) {
        std::optional<TraceRow> following = cursor.next();
        if (row->time < 0 || row->time > options.end) refuse(*row, "is later than the run's end");
        if (following && following->time < row->time) refuse(*following, "is after a later one");
        run.take(*row);
        if (run.done() && run.rows() > 0) break;
        row = std::move(following);
    }
    if (run.rows() == 0)
        throw InputError(record.file().string(), "", fmt::format("holds no message of {}", node.name()),
                         "a record of this scenario");
    return run.end();
}

}  // namespace puckloop::tools
