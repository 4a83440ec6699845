#include "run/driven/driven_run.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "base/version/version.h"
#include "cosim/faults/spec/flash.h"
#include "cosim/faults/spec/typed_bytes.h"
#include "cosim/resume/snapshot_faults.h"
#include "cosim/resume/state_file.h"
#include "run/chips/value_words.h"
#include "run/control/control_place.h"
#include "run/driven/possible_actions.h"
#include "run/driven/possible_faults.h"
#include "run/driven/words.h"
#include "run/factory/node_factory.h"
#include "run/snapshots/origin.h"
#include "scenarios/reader/events/event_tables.h"
#include "scenarios/reader/faults/event_file.h"
#include "scenarios/reader/faults/fault_words.h"
#include "scenarios/values/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

namespace puckloop::tools {

namespace {

using cosim::kNever;
using cosim::Time;
using nlohmann::json;
using nlohmann::ordered_json;

constexpr double kLongest = 720 * 3600.0;  // s
constexpr Time kFinest = cosim::kMicrosecond;
constexpr std::size_t kMostTypedAtOnce = 4096;
constexpr double kSlowestBaud = 50, kFastestBaud = 4e6;

/// "20 ms", or a number of seconds.
Time time_of(const json& request, const char* key) {
    const json& value = request.at(key);
    double seconds = -1;
    if (value.is_number()) {
        seconds = value.get<double>();
    } else if (value.is_string()) {
        try {
            seconds = scenarios::parse_quantity(value.get<std::string>(), scenarios::Dimension::Time);
        } catch (const scenarios::QuantityError& error) {
            throw InputError("", key, error.problem, error.expected);
        }
    }
    if (!(seconds >= 0 && seconds <= kLongest))
        throw InputError("", key, fmt::format("{} is no time of a run", value.dump()), "such as \"20 ms\"");
    return cosim::from_seconds(seconds);
}

/// What `read` and `write` are about: keys, or `what` as people type it.
json with_place(const json& request) {
    if (!request.contains("what")) return request;
    json place = request;
    place.update(place_of_words(request.at("what").get<std::string>()));
    return place;
}

/// `frame` of a filter: keys, or a text.
json frame_of(const json& request) {
    const json frame = request.value("frame", json::object());
    return frame.is_string() ? frame_of_words(frame.get<std::string>()) : frame;
}

constexpr Time kWorldStep = cosim::kMillisecond;

/// The step in which the world takes in what it is given while the run stands at `time`, whose step it has
/// done.
Time world_step(Time time) {
    return (time / kWorldStep + 1) * kWorldStep;
}

/// The world, which stands at `time`, has taken in a command that it was given at `given`.
bool heard_by_world(Time given, Time time) {
    return world_step(given) <= time;
}

}  // namespace

void let_client_drive(RunSetup& setup, const RunRequest& request) {
    for (const auto& [option, given] :
         {std::pair{"--realtime", request.realtime}, std::pair{"--paced", request.paced},
          std::pair{"--gdb", !request.gdb.empty()}, std::pair{"--save-state", !request.save_state.empty()},
          std::pair{"--from-state", !request.from_state.empty()},
          std::pair{"--stats", !request.stats.empty()}})
        if (given)
            throw InputError("", option,
                             "does not go with --control, whose client decides when the run goes on",
                             "one of them");
    if (setup.control.empty()) setup.control = new_control_path();
    for (PlannedNode& node : setup.nodes) {
        if (auto* world = std::get_if<WorldSpec>(&node.what.kind)) {
            world->control = setup.control;
            world->events.live = true;
            world->events.journal = (setup.out / "events.toml").string();
            node.any_thread = false;
        } else if (has_board(node.what)) {
            node.what.care.from_state.reset();
            node.what.care.save_state.reset();
            node.in_process = true;
            node.any_thread = false;
        }
    }
}

DrivenRun::DrivenRun(const RunSetup& setup, const RunRequest& request, Planner planner,
                     const volatile std::sig_atomic_t* interrupted)
    : setup_(setup),
      request_(request),
      planner_(std::move(planner)),
      line_(client_socket_beside(setup.control), interrupted),
      world_(setup.control),
      images_(setup.out / cosim::kFlashedFolder),
      origin_(origin_of(setup, request)),
      no_way_back_(why_not_back(setup, request)),
      next_(setup.from_time) {
    for (const PlannedNode& node : setup.nodes) {
        if (!has_board(node.what)) continue;
        NodeDescription board = node.what;
        images_.remember(board_fields(board).firmware);
        if (const auto* tam = std::get_if<tam::TamSpec>(&board.kind);
            tam != nullptr && !tam->boot_loader.empty())
            images_.remember(tam->boot_loader);
    }
}

std::unique_ptr<cosim::Node> DrivenRun::make_node(const std::string& text) {
    NodeDescription description = decode(text);
    if (!has_board(description)) return tools::make_node(description);
    description = with_images(std::move(description));
    // At power-up: what it was in a snapshot is loaded into it.
    auto node = std::make_unique<DrivenNode>(make_board(description));
    const BoardFields fields = board_fields(description);
    if (counted_.contains(fields.name)) node->count_interrupts(true);
    boards_[fields.name] = std::make_unique<BoardAccess>(*node, fields.firmware);
    return node;
}

void DrivenRun::drive(cosim::RunOptions& options, RunWritten written) {
    written_.emplace(written);
    history_.begin(request_.snapshot, {});
    if (no_way_back_.empty()) remember_at_ = history_.next(setup_.from_time);
    options.stand_next = [this](Time after) {
        const Time asked = next_ && (*next_ > after || !begun_) ? *next_ : kNever;
        return std::min(asked, remember_at_ > after ? remember_at_ : kNever);
    };
    options.stand = [this](Time time, const TakeSnapshot& take) {
        now_ = time;
        if (time >= remember_at_) remember(take);
        if (!next_ || time < *next_) return;
        begun_ = true;
        stand(take);
    };
}

void DrivenRun::remember(const TakeSnapshot& take) {
    remember_at_ = history_.next(now_);
    // A change that waits for its board's next instruction is in no snapshot: later, then.
    if (waiting_change() != nullptr) return;
    cosim::RunSnapshot snapshot = take();
    history_.take(snapshot, written_->place());
    remember_at_ = history_.next(now_);
}

void DrivenRun::stand(const TakeSnapshot& take) {
    next_.reset();
    if (return_) {
        if (!returned()) return;
    } else if (step_) {
        const bool holds = met();
        if (!holds && now_ < step_->until) {  // on to where its condition is looked at again
            next_ = next_look();
            return;
        }
        ordered_json done = reply(step_->id);
        done["met"] = holds || (step_->condition.is_null() && step_->board == nullptr);
        if (frames_.seen() && !frames_.found().is_null()) done["frame"] = frames_.found();
        done["acts"] = world_.take_replies();
        for (const ordered_json& one : done["acts"]) {
            while (answered_ < deeds_.size() && !deeds_[answered_].write.is_null())
                ++answered_;
            if (answered_ < deeds_.size()) deeds_[answered_++].refused = one.contains("refused");
        }
        frames_.wait_for_nothing();
        step_.reset();
        line_.send(done);
    } else {
        if (!line_.await_client()) return;
        line_.send(greeting());
    }
    serve(take);
}

bool DrivenRun::returned() {
    // A command that the world had not heard yet where the run begins again is given there once more.
    const bool begins = std::exchange(begins_again_, false);
    for (const Deed& deed : deeds_) {
        const bool now = deed.time == now_;
        if (now && !deed.write.is_null()) board(deed.write).write(deed.write);
        if (deed.write.is_null() && (now || (begins && deed.time < now_)) &&
            !heard_by_world(deed.time, return_->to))
            world_.act(deed.command);
    }
    if (now_ < return_->to) {
        next_ = return_->to;
        for (const Deed& deed : deeds_)
            if (deed.time > now_) next_ = std::min(*next_, deed.time);
        return false;
    }
    for (const std::string& name : counted_)  // from here on, not from the snapshot
        boards_.at(name)->node().count_interrupts(true);
    line_.send(reply(return_->id));
    return_.reset();
    step_.reset();
    return true;
}

Time DrivenRun::next_look() {
    Time next = now_ + step_->every;
    // Just behind the begin of the next instruction, which is then executed whole; of a board that hangs it
    // should have been, and is not.
    if (step_->board != nullptr && !step_->board->chip().asleep()) {
        const Time begin = step_->board->next_instruction();
        if (begin > step_->looked) next = begin + 1;
        step_->looked = std::max(now_, begin);
    }
    return std::min(step_->until, next);
}

bool DrivenRun::met() {
    if (step_->board != nullptr) return step_->board->chip().instructions() >= step_->instructions;
    const json& condition = step_->condition;
    if (condition.is_null()) return false;
    if (condition.contains("frame") || condition.contains("text")) return frames_.seen();
    return compare(condition);
}

bool DrivenRun::compare(const json& condition) {
    const auto value = board(condition).read(condition).at("value").get<std::uint64_t>();
    return comparison_holds(value, condition.value("is", "=="), condition.at("value").get<std::uint64_t>());
}

void DrivenRun::serve(const TakeSnapshot& take) {
    for (bool go_on = false; !go_on;) {
        const std::optional<std::string> text = line_.next();
        if (!text) {
            if (!line_.connected()) end("its client went away", false);
            return;
        }
        const json request = json::parse(*text, nullptr, false);
        const json id = request.is_object() ? request.value("id", json()) : json();
        try {
            if (!request.is_object()) throw InputError("", "request", "is no JSON object", "one on one line");
            const ordered_json answered = answer(request, take, go_on);
            if (!answered.is_null()) line_.send(answered);
        } catch (const json::exception& error) {
            line_.send({{"id", id},
                        {"ok", false},
                        {"error", fmt::format("a key is missing or of another type: {}", error.what())}});
        } catch (const std::runtime_error& error) {
            line_.send({{"id", id}, {"ok", false}, {"error", error.what()}});
        }
    }
}

ordered_json DrivenRun::answer(const json& request, const TakeSnapshot& take, bool& go_on) {
    const std::string op = request.at("op");
    ordered_json answered = reply(request.value("id", json()));
    if (op == "step") {
        begin_step(request);
        go_on = true;
        return nullptr;
    }
    if (op == "end") {
        end("its client ended the run", true);
        step_ = Step{request.value("id", json()), kNever, 0, json()};
        go_on = true;
        return nullptr;
    }
    if (op == "read") {
        answered.update(board(request).read(with_place(request)));
        answered["text"] = value_text(answered);
    } else if (op == "where") {
        answered.update(board(request).where());
    } else if (op == "interrupts") {
        count_interrupts(request);
    } else if (op == "faults") {
        answered.update(possible_faults(setup_.scenario));
    } else if (op == "actions") {
        answered.update(possible_actions(setup_.scenario));
    } else if (op == "write") {
        const json change = with_place(request);
        board(change).write(change);
        deeds_.push_back({now_, change});
    } else if (op == "capture") {
        frames_.capture(FrameFilter(frame_of(request), setup_.links));
    } else if (op == "frames") {
        std::size_t lost = 0;
        answered["frames"] = frames_.take(lost);
        answered["lost"] = lost;
    } else if (op == "act") {
        const std::string command = request.at("command");
        world_.act(command);
        deeds_.push_back({now_, nullptr, command});
    } else if (op == "save") {
        save(request, take);
    } else if (op == "back") {
        go_back(request);
    } else if (op == "fault") {
        add_fault(request, take);
    } else if (op == "type") {
        type(request, take);
    } else if (op == "flash") {
        flash(request, take);
    } else if (op != "info") {
        constexpr std::array<std::string_view, 17> kOps{
            "info",    "step", "read",   "where", "write", "interrupts", "capture", "frames", "act",
            "actions", "save", "faults", "back",  "fault", "type",       "flash",   "end"};
        throw InputError(
            "", "op", fmt::format("there is no '{}'", op),
            fmt::format("{}{}", fmt::join(kOps, ", "), did_you_mean(op, {kOps.begin(), kOps.end()})));
    }
    if (op == "info") answered.update(greeting());
    return answered;
}

void DrivenRun::count_interrupts(const json& request) {
    const bool on = request.value("count", true);
    board(request).node().count_interrupts(on);
    const std::string name = request.at("node");
    if (on)
        counted_.insert(name);
    else
        counted_.erase(name);
}

void DrivenRun::begin_step(const json& request) {
    Step step{request.value("id", json()), 0, 0, request.value("until", json())};
    if (request.contains("instructions")) {
        begin_instructions(request, step);
        next_.reset();
        step_ = std::move(step);
        next_ = next_look();
        return;
    }
    const bool to = request.contains("to");
    if (to == request.contains("for"))
        throw InputError("", "step", "needs one of 'to' and 'for'", R"({"op": "step", "for": "20 ms"})");
    step.until = to ? time_of(request, "to") : cosim::later(now_, time_of(request, "for"));
    if (step.until <= now_)
        throw InputError("", to ? "to" : "for",
                         fmt::format("{:.9f} s is not after now, {:.9f} s", cosim::to_seconds(step.until),
                                     cosim::to_seconds(now_)),
                         "a later time");
    if (step.condition.is_string()) {
        const std::string only = boards_.size() == 1 ? boards_.begin()->first : std::string();
        step.condition = condition_of_words(step.condition.get<std::string>(), request.value("node", only));
    }
    if (!step.condition.is_null()) {
        step.every = request.contains("every") ? time_of(request, "every") : cosim::kMillisecond;
        if (step.every < kFinest) throw InputError("", "every", "is too short", "1 us or more");
        const json& condition = step.condition;
        if ((condition.contains("frame") || condition.contains("text")) && request.value("continues", false))
            frames_.wait_on();
        else if (condition.contains("frame") || condition.contains("text"))
            frames_.wait_for(FrameFilter(frame_of(condition), setup_.links), condition.value("text", ""));
        else
            compare(condition);  // what cannot be looked at is refused now
    }
    next_ = step.condition.is_null() ? step.until : std::min(step.until, now_ + step.every);
    step_ = std::move(step);
}

void DrivenRun::begin_instructions(const json& request, Step& step) {
    constexpr int kMost = 100'000;
    constexpr Time kLongestWait = 100 * cosim::kMillisecond;
    if (request.contains("to") || request.contains("for") || request.contains("until"))
        throw InputError("", "instructions", "does not go with 'to', 'for' or 'until'",
                         R"({"op": "step", "node": "robot0.pic", "instructions": 1})");
    const auto count = request.at("instructions").get<std::int64_t>();
    if (count < 1 || count > kMost)
        throw InputError("", "instructions", fmt::format("{} is out of range", count), "1 to 100000");
    step.board = &board(request).node();
    step.instructions = step.board->chip().instructions() + static_cast<std::uint64_t>(count);
    step.until = now_ + kLongestWait;
    step.every = kFinest;
    step.looked = now_ - 1;
}

const std::string* DrivenRun::waiting_change() const {
    for (const auto& [name, access] : boards_)
        if (access->node().changes_wait()) return &name;
    return nullptr;
}

void DrivenRun::refuse_waiting_change(const char* op) const {
    if (const std::string* board = waiting_change())
        throw InputError("", op,
                         fmt::format("a register of {} is written before its next instruction", *board),
                         "a step before it");
}

void DrivenRun::save(const json& request, const TakeSnapshot& take) {
    refuse_waiting_change("save");
    cosim::RunSnapshot snapshot = take();
    snapshot.build = cosim::build_id();
    snapshot.origin = origin_;
    snapshot.trace = written_->trace->written();
    cosim::write_snapshot(request.at("file").get<std::string>(), snapshot);
}

void DrivenRun::go_back(const json& request) {
    if (!no_way_back_.empty()) throw InputError("", "back", no_way_back_, "a run that can go back");
    if (!request.contains("to"))
        throw InputError("", "back", "needs 'to'", R"({"op": "back", "to": "1.5 s"})");
    const Time to = time_of(request, "to");
    if (to >= now_ || to < setup_.from_time)
        throw InputError(
            "", "to",
            fmt::format("{:.9f} s is not between the run's beginning, {:.9f} s, and now, {:.9f} s",
                        cosim::to_seconds(to), cosim::to_seconds(setup_.from_time), cosim::to_seconds(now_)),
            "an earlier time");
    RunRequest with = request_;
    for (const Typed& typed : typed_)
        if (typed.time >= to) std::erase(with.faults, typed.fault);
    RunSetup next = planned(with);
    origin_ = origin_of(next, with);
    request_ = std::move(with);
    std::erase_if(typed_, [to](const Typed& typed) { return typed.time >= to; });
    std::erase_if(deeds_, [to](const Deed& deed) { return deed.time >= to; });
    add_events(next, to);
    setup_ = std::move(next);
    return_ = Return{history_.at_or_before(to), to, request.value("id", json())};
    throw cosim::Reverted{};
}

void DrivenRun::add_fault(const json& request, const TakeSnapshot& take) {
    if (!no_way_back_.empty()) throw InputError("", "fault", no_way_back_, "--fault when the run is started");
    refuse_waiting_change("fault");
    RunRequest with = request_;
    const json& faults = request.at("fault");
    for (const json& fault : faults.is_array() ? faults : json::array({faults}))
        with.faults.push_back(fault.get<std::string>());
    go_on_with(std::move(with), request.value("id", json()), take);
}

void DrivenRun::type(const json& request, const TakeSnapshot& take) {
    constexpr int kBitsOfFrame = 10;
    if (!no_way_back_.empty()) throw InputError("", "type", no_way_back_, "a run that can go back");
    refuse_waiting_change("type");
    const bool as_text = request.contains("text");
    if (as_text == request.contains("data"))
        throw InputError("", "type", "needs one of 'text' and 'data'", R"("text": "d,100,100\r")");
    const std::string given = request.at(as_text ? "text" : "data").get<std::string>();
    std::vector<std::uint8_t> bytes =
        as_text ? std::vector<std::uint8_t>(given.begin(), given.end()) : cosim::typed_bytes(given);
    if (bytes.empty())
        throw InputError("", as_text ? "text" : "data", "are no bytes",
                         as_text ? "a text" : "pairs of hexadecimal digits");
    if (bytes.size() > kMostTypedAtOnce)
        throw InputError("", "type", fmt::format("{} bytes are too many", bytes.size()), "at most 4096");
    Typed typed{now_, now_, request.at("link").get<std::string>(), request.at("from").get<std::string>()};
    const auto link = std::find_if(setup_.links.begin(), setup_.links.end(), [&](const auto& one) {
        return one.name == typed.link && one.nominal_baud > 0.0;
    });
    if (link == setup_.links.end()) {
        std::vector<std::string_view> known;
        for (const cosim::LinkSpec& one : setup_.links)
            if (one.nominal_baud > 0.0) known.push_back(one.name);
        throw InputError("", "link", fmt::format("there is no serial line '{}'", typed.link),
                         fmt::format("one of {}{}", fmt::join(known, ", "), did_you_mean(typed.link, known)));
    }
    const double baud = request.value("baud", link->nominal_baud);
    if (!(baud >= kSlowestBaud && baud <= kFastestBaud))
        throw InputError("", "baud", fmt::format("{:g} is no rate of a serial line", baud), "50 to 4000000");
    for (const Typed& before : typed_)  // behind what was typed there and is still on its way
        if (before.link == typed.link && before.from == typed.from)
            typed.end = std::max(typed.end, before.end);
    typed.fault =
        fmt::format(R"({} link={} from={} begin="{}.{:012} s" data={:02x} baud={} may_not_fire=true)",
                    cosim::kTypedKind, typed.link, typed.from, typed.end / cosim::kSecond,
                    typed.end % cosim::kSecond, fmt::join(bytes, ""), baud);
    typed.end =
        cosim::later(typed.end, cosim::from_seconds(kBitsOfFrame * static_cast<double>(bytes.size()) / baud));
    RunRequest with = request_;
    with.faults.push_back(typed.fault);
    go_on_with(std::move(with), request.value("id", json()), take, [&] { typed_.push_back(typed); });
}

void DrivenRun::flash(const json& request, const TakeSnapshot& take) {
    if (!no_way_back_.empty()) throw InputError("", "flash", no_way_back_, "a run that can go back");
    refuse_waiting_change("flash");
    board(request);  // refuses what is none
    const std::string name = request.at("node"), file = request.at("file");
    const auto node = std::find_if(setup_.nodes.begin(), setup_.nodes.end(),
                                   [&](const PlannedNode& one) { return one.name == name; });
    const KeptImages::Copy image = images_.copy(node->what, file);
    std::string source = std::filesystem::absolute(file).lexically_normal().string();
    std::replace_if(
        source.begin(), source.end(), [](char c) { return c == '"' || c == '\n'; }, '?');
    const std::string fault =
        fmt::format(R"({} node={} at="{}.{:012} s" image="{}" sha256={} source="{}" may_not_fire=true)",
                    cosim::kFlashKind, name, now_ / cosim::kSecond, now_ % cosim::kSecond, image.file,
                    image.sha256, source);
    RunRequest with = request_;
    with.faults.push_back(fault);
    go_on_with(std::move(with), request.value("id", json()), take,
               [&] { typed_.push_back({.time = now_, .end = now_, .fault = fault}); });
}

std::string DrivenRun::image_of(const std::string& board) const {
    std::string image;
    cosim::Time latest = -1;
    for (const cosim::FaultSpec& fault : setup_.scenario.faults) {
        if (fault.kind != cosim::kFlashKind || fault.node != board || fault.begin >= now_ ||
            fault.begin < latest)
            continue;
        latest = fault.begin;
        image = fault.parameters.text("image");
    }
    return image;
}

void DrivenRun::go_on_with(RunRequest with, const json& id, const TakeSnapshot& take,
                           const std::function<void()>& accepted) {
    RunSetup next = planned(with);
    check_origin(origin_, next, now_, "", images_.remembered());
    check_boards(next);
    // Of one snapshot both: it is checked first, and kept then.
    cosim::RunSnapshot here = take();
    cosim::check_link_faults(here, next.links, next.scenario.faults, next.scenario.seed);
    remember([&] { return std::move(here); });
    if (accepted) accepted();
    origin_ = origin_of(next, with);
    add_events(next, now_);
    setup_ = std::move(next);
    request_ = std::move(with);
    return_ = Return{history_.at_or_before(now_), now_, id};
    throw cosim::Reverted{};
}

/// What only a board itself refuses of its faults: a register that its chip has not, an image for another
/// one.
void DrivenRun::check_boards(const RunSetup& next) const {
    for (std::size_t i = 0; i < next.nodes.size(); ++i) {
        const PlannedNode& node = next.nodes[i];
        if (!has_board(node.what) || node.what.faults.size() == setup_.nodes[i].what.faults.size()) continue;
        make_board(with_images(without_files(node.what)));
    }
}

NodeDescription DrivenRun::with_images(NodeDescription board) const {
    const BoardFields there = board_fields(board);
    there.firmware = images_.as_it_was(there.firmware);
    if (auto* tam = std::get_if<tam::TamSpec>(&board.kind))
        tam->boot_loader = images_.as_it_was(tam->boot_loader);
    return board;
}

void DrivenRun::record_faults() const {
    std::string text;
    if (!request_.events.empty())
        for (const TomlValue& table : scenarios::fault_tables_of(request_.events))
            text += scenarios::fault_toml(table);
    for (const std::string& words : request_.faults)
        text += scenarios::fault_toml(scenarios::fault_table_of(words));
    if (text.empty()) return;
    std::ofstream file(setup_.out / "events.toml", std::ios::app);
    file << text << std::flush;
    if (!file) throw RunError(fmt::format("{}: cannot be written", (setup_.out / "events.toml").string()));
}

RunSetup DrivenRun::planned(const RunRequest& request) const {
    RunSetup next = planner_(request);
    next.control = setup_.control;
    let_client_drive(next, request);
    return next;
}

/// What the world has heard by `time` is an event of it from the beginning: it is executed from there.
void DrivenRun::add_events(RunSetup& setup, Time time) const {
    for (PlannedNode& node : setup.nodes) {
        auto* world = std::get_if<WorldSpec>(&node.what.kind);
        if (world == nullptr) continue;
        for (const Deed& deed : deeds_) {
            if (!deed.write.is_null() || deed.refused || !heard_by_world(deed.time, time)) continue;
            physics::Event event;
            event.name = "command";
            event.at = world_step(deed.time) + kWorldStep;
            event.action = scenarios::parse_command(deed.command);
            world->events.events.push_back(std::move(event));
        }
    }
}

const cosim::RunSnapshot* DrivenRun::begin_again() {
    boards_.clear();
    world_.forget();
    std::error_code ignored;
    std::filesystem::remove(setup_.control, ignored);  // of the world that was: the next one listens there
    answered_ = deeds_.size();
    for (std::size_t i = deeds_.size(); i > 0; --i)  // what is given to the world again is answered again
        if (deeds_[i - 1].write.is_null() && !heard_by_world(deeds_[i - 1].time, return_->to))
            answered_ = i - 1;
    const Time begin = history_.time(return_->instant);
    kept_.reset();
    if (return_->instant > 0) kept_ = history_.place(return_->instant);
    from_ = history_.snapshot(return_->instant);
    history_.forget_after(return_->instant);
    remember_at_ = history_.next(begin);
    frames_.go_back(return_->to);
    begun_ = false;
    begins_again_ = true;
    next_ = begin;
    step_ = Step{return_->id, kNever, 0, json()};  // should the run end on its way
    return from_.get();
}

/// By the first board, at its next advance.
void DrivenRun::end(const std::string& reason, bool success) {
    ended_ = true;
    next_.reset();
    if (!boards_.empty()) boards_.begin()->second->node().ask_to_stop({now_, success, reason});
}

BoardAccess& DrivenRun::board(const json& request) {
    const std::string name = request.at("node");
    const auto found = boards_.find(name);
    if (found != boards_.end()) {
        found->second->use_image(image_of(name));
        return *found->second;
    }
    std::vector<std::string_view> known;
    for (const auto& one : boards_)
        known.push_back(one.first);
    if (name.empty())
        throw InputError("", "node", "no board is named", fmt::format("one of {}", fmt::join(known, ", ")));
    throw InputError("", "node", fmt::format("the run has no board '{}'", name),
                     fmt::format("one of {}{}", fmt::join(known, ", "), did_you_mean(name, known)));
}

ordered_json DrivenRun::reply(const json& id) const {
    return {{"id", id}, {"ok", true}, {"time_s", cosim::to_seconds(now_)}, {"time_ps", now_}};
}

ordered_json DrivenRun::greeting() const {
    const Version& version = program_version();
    ordered_json nodes = ordered_json::array(), boards = ordered_json::array(), links = ordered_json::array();
    for (const PlannedNode& node : setup_.nodes)
        nodes.push_back(node.name);
    for (const auto& one : boards_)
        boards.push_back(one.first);
    for (const cosim::LinkSpec& link : setup_.links)
        links.push_back({{"name", link.name}, {"a", link.a.node}, {"b", link.b.node}});
    return {{"protocol", kProtocol},
            {"revision", kRevision},
            {"version", version.number},
            {"commit", version.commit},
            {"time_s", cosim::to_seconds(now_)},
            {"time_ps", now_},
            {"scenario", request_.scenario.filename().string()},
            {"results", setup_.out.string()},
            {"nodes", nodes},
            {"boards", boards},
            {"links", links}};
}

void DrivenRun::over(cosim::Outcome& outcome) {
    try {
        record_faults();
    } catch (const std::runtime_error& error) {
        outcome.warnings.emplace_back(error.what());
    }
    if (!step_) return;
    now_ = outcome.simulated;
    ordered_json done = reply(step_->id);
    done["met"] = step_->condition.is_null() ? ended_ : frames_.seen();
    done["ended"] = true;
    done["success"] = outcome.success;
    done["ended_why"] = outcome.text;
    line_.send(done);
}

}  // namespace puckloop::tools
