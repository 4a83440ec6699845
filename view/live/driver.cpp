#include "view/live/driver.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace puckloop::view {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kStepMs = 100;  // while it plays: what trajectories are recorded in
constexpr int kMostStepMs = 10'000;
constexpr double kMostUntilMs = 60'000;
constexpr double kMostSpeed = 1000.0;
constexpr std::size_t kLongestCommand = 1000, kLongestName = 64;

}  // namespace

Driver::Driver(const fs::path& folder) : run_(folder) {
    const auto first = json::parse(run_.greeting());
    time_s_ = first.value("time_s", 0.0);
    auto possible = json::parse(run_.ask(R"({"op": "faults"})"), nullptr, false);
    if (!possible.is_object()) possible = json::object();
    const auto actions = json::parse(run_.ask(R"({"op": "actions"})"), nullptr, false);
    if (actions.is_object()) possible.update(actions);
    possible["scenario"] = first.value("scenario", "");
    possible["boards"] = first.value("boards", json::array());
    possible_ = possible.dump(-1, ' ', false, json::error_handler_t::replace);
    thread_ = std::thread([this] { run(); });
}

Driver::~Driver() {
    {
        const std::lock_guard lock(mutex_);
        end_ = true;
        changed_.notify_all();
    }
    thread_.join();
}

void Driver::run() noexcept {
    try {
        while (serve()) {
        }
    } catch (const std::exception& error) {
        const std::lock_guard lock(mutex_);
        if (why_.empty()) why_ = error.what();
    }
    const std::lock_guard lock(mutex_);
    over_ = true;
    playing_ = false;
}

/// One step or act; false when the run is over.
bool Driver::serve() {
    using Clock = std::chrono::steady_clock;
    Work work;
    double speed = 0.0;
    bool ends = false;
    {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return end_ || playing_ || !waiting_.empty(); });
        ends = end_;
        busy_ = true;
        if (!waiting_.empty()) {
            work = waiting_.front();
            waiting_.pop_front();
        } else {
            work.ms = kStepMs;
            // Slower than real time: finer, so that it moves.
            if (speed_ > 0 && speed_ < 1)
                work.ms = std::max(1, static_cast<int>(std::lround(kStepMs * speed_)));
            speed = speed_;
        }
    }
    if (ends) {
        end_run();
        return false;
    }
    const auto begun = Clock::now();
    carry_out(work);
    std::unique_lock lock(mutex_);
    busy_ = false;
    if (over_) return false;
    if (work.kind == Work::Kind::Step && speed > 0) {
        const auto due = begun + std::chrono::duration_cast<Clock::duration>(
                                     std::chrono::duration<double>(1e-3 * work.ms / speed));
        changed_.wait_until(lock, due, [this] { return end_ || !playing_ || !waiting_.empty(); });
    }
    return true;
}

void Driver::carry_out(const Work& work) {
    switch (work.kind) {
    case Work::Kind::Step:
        step(json{{"op", "step"}, {"for", fmt::format("{} ms", work.ms)}});
        break;
    case Work::Kind::Instruction:
        step(json{{"op", "step"}, {"node", work.board}, {"instructions", 1}});
        break;
    case Work::Kind::Act:
        return act(work.text);
    case Work::Kind::Until:
        until(work);
        break;
    case Work::Kind::Back:
        restart(json{{"op", "back"}, {"to", work.to_s}}.dump(), fmt::format("back to {:.6g} s", work.to_s));
        break;
    case Work::Kind::Fault:
        restart(json{{"op", "fault"}, {"fault", work.text}}.dump(), "fault " + work.text);
        break;
    case Work::Kind::Type:
        type(work.text);
        break;
    case Work::Kind::Flash:
        restart(json{{"op", "flash"}, {"node", work.board}, {"file", work.text}}.dump(),
                fmt::format("flash {} into {}", fs::path(work.text).filename().string(), work.board));
        break;
    case Work::Kind::Ask:
        run_.ask(work.text);
        break;
    case Work::Kind::Look:
        break;
    }
    look();
}

/// What the page looks at, as it is now.
void Driver::look() {
    json items;
    std::string board;
    {
        const std::lock_guard lock(mutex_);
        if (over_ || board_.empty()) return;
        items = json::parse(items_);
        board = board_;
    }
    json values = json::array();
    for (const json& item : items) {
        const json asked{{"op", "read"}, {"node", board}, {"what", item}};
        json reply = json::parse(run_.ask(asked.dump()), nullptr, false);
        if (!reply.is_object()) throw RunError("a reply of the run that is none");
        values.push_back(std::move(reply));
    }
    const json where = json::parse(run_.ask(json{{"op", "where"}, {"node", board}}.dump()), nullptr, false);
    const std::lock_guard lock(mutex_);
    look_ = json{{"board", board}, {"time_s", time_s_}, {"where", where}, {"values", values}}.dump(
        -1, ' ', false, json::error_handler_t::replace);
}

/// In pieces, so that it can be stopped.
void Driver::until(const Work& work) {
    json asked{{"op", "step"}, {"until", work.text}};
    if (!work.board.empty()) asked["node"] = work.board;
    {
        const std::lock_guard lock(mutex_);
        until_ = work.text;
    }
    for (int done = 0; done < work.ms;) {
        const int piece = std::min(kStepMs, work.ms - done);
        asked["for"] = fmt::format("{} ms", piece);
        const auto reply = json::parse(run_.ask(asked.dump()), nullptr, false);
        if (!reply.is_object()) throw RunError("a reply of the run that is none");
        done += piece;
        asked["continues"] = true;
        const std::lock_guard lock(mutex_);
        time_s_ = reply.value("time_s", time_s_);
        const bool ok = reply.value("ok", false), met = ok && reply.value("met", false);
        over_ = reply.value("ended", false);
        if (over_) why_ = reply.value("ended_why", "");
        const bool stopped = std::exchange(stop_, false) || end_;
        if (ok && !met && !over_ && !stopped && done < work.ms) continue;
        until_.clear();
        note("until " + work.text,
             !ok ? reply.value("error", "refused")
             : met
                 ? fmt::format("{:.6f} s: it holds", time_s_)
                 : fmt::format("{:.6f} s: it did not hold until now{}", time_s_, stopped ? ", stopped" : ""),
             !met);
        return;
    }
}

/// The run is begun again from an earlier time or with a fault.
void Driver::restart(const std::string& request, const std::string& command) {
    const auto reply = json::parse(run_.ask(request), nullptr, false);
    if (!reply.is_object()) throw RunError("a reply of the run that is none");
    const std::lock_guard lock(mutex_);
    time_s_ = reply.value("time_s", time_s_);
    const bool ok = reply.value("ok", false);
    note(command, ok ? fmt::format("{:.6f} s: done", time_s_) : reply.value("error", "refused"), !ok);
    if (ok) ++epoch_;
    if (!reply.value("ended", false)) return;
    over_ = true;
    why_ = reply.value("ended_why", "");
}

void Driver::type(const std::string& request) {
    const json asked = json::parse(request);
    restart(request, fmt::format("type {} into {} as {}", asked.at("text").dump(),
                                 asked.at("link").get<std::string>(), asked.at("from").get<std::string>()));
}

/// Under the lock.
void Driver::note(const std::string& command, const std::string& answer, bool refused) {
    acts_.push_back({++act_number_, command, answer, refused});
    if (acts_.size() > kKeptActs) acts_.erase(acts_.begin());
}

void Driver::step(const json& request) {
    const auto reply = json::parse(run_.ask(request.dump()), nullptr, false);
    if (!reply.is_object()) throw RunError("a reply of the run that is none");
    const std::lock_guard lock(mutex_);
    time_s_ = reply.value("time_s", time_s_);
    if (!reply.value("ok", true)) why_ = reply.value("error", "");
    for (const auto& done : reply.value("acts", json::array())) {
        const std::string command = done.value("act", "");
        for (Act& act : acts_)
            if (act.answer.empty() && act.command == command) {
                act.refused = done.contains("refused");
                act.answer = act.refused ? done.value("refused", "")
                                         : fmt::format("{:.3f} s: {}", done.value("at_s", 0.0),
                                                       done.value("done", ""));
                break;
            }
    }
    if (!reply.value("ended", false)) return;
    over_ = true;
    why_ = reply.value("ended_why", "");
}

void Driver::act(const std::string& command) {
    const auto reply =
        json::parse(run_.ask(json{{"op", "act"}, {"command", command}}.dump()), nullptr, false);
    const std::lock_guard lock(mutex_);
    const bool ok = reply.is_object() && reply.value("ok", false);
    note(command, ok ? "" : reply.is_object() ? reply.value("error", "refused") : "refused", !ok);
}

void Driver::end_run() {
    const auto reply = json::parse(run_.ask(json{{"op", "end"}}.dump()), nullptr, false);
    const std::lock_guard lock(mutex_);
    if (reply.is_object()) {
        time_s_ = reply.value("time_s", time_s_);
        why_ = reply.value("ended_why", "");
    }
}

std::string Driver::request(const std::string& text) {
    const auto asked = json::parse(text, nullptr, false);
    if (!asked.is_object()) return "not a request";
    const auto string_of = [&](const char* key) {
        const auto found = asked.find(key);
        return found != asked.end() && found->is_string() ? found->get<std::string>() : std::string();
    };
    const auto number_of = [&](const char* key, double otherwise) {
        const auto found = asked.find(key);
        return found != asked.end() && found->is_number() ? found->get<double>() : otherwise;
    };
    const std::string page = string_of("page"), what = string_of("do");
    if (page.empty() || page.size() > kLongestName) return "no page is named";
    const std::lock_guard lock(mutex_);
    if (over_) return "the run is over";
    if (driver_.empty() || what == "take") driver_ = page;
    if (driver_ != page) return "another page drives";
    if (waiting_.size() >= kMostWaiting) return "the run is slow: too much is waiting";
    if (what == "play") {
        const double speed = number_of("speed", 1.0);
        if (!(speed >= 0.0 && speed <= kMostSpeed)) return "a speed from 0 to 1000 is expected";
        speed_ = speed;
        playing_ = true;
    } else if (what == "pause") {
        playing_ = false;
        stop_ = !until_.empty();
    } else if (what == "step") {
        const double ms = number_of("ms", 0.0);
        if (!(ms >= 1.0 && ms <= kMostStepMs)) return "a step of 1 to 10,000 ms is expected";
        playing_ = false;
        waiting_.push_back({Work::Kind::Step, static_cast<int>(ms)});
    } else if (what == "instruction") {
        const std::string board = string_of("board");
        if (board.empty() || board.size() > kLongestName) return "a board's name is expected";
        playing_ = false;
        waiting_.push_back({.kind = Work::Kind::Instruction, .board = board});
    } else if (what == "act") {
        const std::string command = string_of("command");
        if (command.empty() || command.size() > kLongestCommand) return "a command is expected";
        waiting_.push_back({.kind = Work::Kind::Act, .text = command});
    } else if (what == "until") {
        const double ms = number_of("ms", kMostUntilMs);
        const std::string condition = string_of("condition"), board = string_of("board");
        if (condition.empty() || condition.size() > kLongestCommand) return "a condition is expected";
        if (board.size() > kLongestName) return "a board's name is expected";
        if (!(ms >= 1.0 && ms <= kMostUntilMs)) return "1 to 60,000 ms are expected";
        playing_ = false;
        stop_ = false;
        waiting_.push_back(
            {.kind = Work::Kind::Until, .ms = static_cast<int>(ms), .text = condition, .board = board});
    } else if (what == "back") {
        const double to = number_of("to_s", -1.0);
        if (!(to >= 0.0)) return "a time is expected";
        playing_ = false;
        waiting_.push_back({.kind = Work::Kind::Back, .to_s = to});
    } else if (what == "fault") {
        const std::string fault = string_of("fault");
        if (fault.empty() || fault.size() > kLongestCommand) return "a fault is expected";
        waiting_.push_back({.kind = Work::Kind::Fault, .text = fault});
    } else if (what == "type") {
        const std::string link = string_of("link"), from = string_of("from"), typed = string_of("text");
        if (link.empty() || from.empty() || link.size() > kLongestName || from.size() > kLongestName)
            return "a line and one of its ends are expected";
        if (typed.empty() || typed.size() > kLongestCommand)
            return "a text of at most 1000 bytes is expected";
        const json request{{"op", "type"}, {"link", link}, {"from", from}, {"text", typed}};
        waiting_.push_back({.kind = Work::Kind::Type, .text = request.dump()});
    } else if (what == "interrupts") {
        const std::string board = string_of("board");
        if (board.empty() || board.size() > kLongestName) return "a board's name is expected";
        const auto on = asked.find("count");
        if (on == asked.end() || !on->is_boolean()) return "whether they are counted is expected";
        const json request{{"op", "interrupts"}, {"node", board}, {"count", on->get<bool>()}};
        waiting_.push_back({.kind = Work::Kind::Ask, .text = request.dump()});
    } else if (what == "flash") {
        const std::string board = string_of("board"), file = string_of("file");
        if (board.empty() || board.size() > kLongestName) return "a board's name is expected";
        if (file.empty() || file.size() > kLongestCommand) return "a file is expected";
        std::error_code none;  // the run may have been started in another folder
        playing_ = false;
        waiting_.push_back(
            {.kind = Work::Kind::Flash, .text = fs::absolute(file, none).string(), .board = board});
    } else if (what == "look") {
        const auto items = asked.find("items");
        const std::string board = string_of("board");
        if (items == asked.end() || !items->is_array() || items->size() > kMostItems ||
            !std::all_of(items->begin(), items->end(), [](const json& item) {
                return item.is_string() && item.get_ref<const std::string&>().size() <= kLongestName;
            }))
            return "a list of at most 40 things to read is expected";
        if (board.size() > kLongestName) return "a board's name is expected";
        board_ = board;
        items_ = items->dump();
        look_ = "null";
        if (!board.empty() && !playing_) waiting_.push_back({.kind = Work::Kind::Look});
    } else if (what == "end") {
        end_ = true;
    } else if (what != "take") {
        return "an unknown request";
    }
    changed_.notify_all();
    return "";
}

std::string Driver::state() const {
    const std::lock_guard lock(mutex_);
    json acts = json::array();
    for (const Act& act : acts_)
        acts.push_back({{"number", act.number},
                        {"command", act.command},
                        {"answer", act.answer},
                        {"refused", act.refused}});
    const json state{{"time_s", time_s_}, {"playing", playing_}, {"speed", speed_},
                     {"over", over_},     {"why", why_},         {"driver", driver_},
                     {"acts", acts},      {"epoch", epoch_},     {"look", json::parse(look_)},
                     {"until", until_}};
    return state.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::uint64_t Driver::epoch() const {
    const std::lock_guard lock(mutex_);
    return epoch_;
}

bool Driver::stands() const {
    const std::lock_guard lock(mutex_);
    return !playing_ && !busy_ && waiting_.empty();
}

bool Driver::on() const {
    const std::lock_guard lock(mutex_);
    return !over_;
}

}  // namespace puckloop::view
