#include "bench/debugger/dap_server.h"

#include "base/error.h"
#include "base/json.h"
#include "base/text/suggest.h"
#include "bench/debugger/dap_channel.h"
#include "bench/debugger/dap_views.h"

#include <fmt/format.h>

#include <charconv>
#include <csignal>
#include <deque>
#include <functional>
#include <map>
#include <memory>

namespace puckloop::exec::debugger {

using debug::Stop;
using nlohmann::json;

namespace {

constexpr int kThread = 1;
constexpr std::int64_t kMostInstructions = 10000;
constexpr std::uint32_t kMostReadMemory = 1u << 20;

/// An argument of a request, with what it must be. Throws InputError.
template <class T>
T argument(const json& arguments, const char* name, T otherwise, const char* expected) {
    const auto found = arguments.find(name);
    if (found == arguments.end() || found->is_null()) return otherwise;
    try {
        return found->get<T>();
    } catch (const json::exception&) {
        throw InputError("", name, fmt::format("{} cannot be used", found->dump()), expected);
    }
}

std::uint32_t reference(const json& arguments) {
    const auto text = argument<std::string>(arguments, "memoryReference", "", "a string such as 0x001f48");
    std::uint32_t address = 0;
    const char* const last = text.data() + text.size();
    if (text.starts_with("0x")) {
        const auto [end, error] = std::from_chars(text.data() + 2, last, address, 16);
        if (error == std::errc{} && end == last && text.size() > 2) return address;
    }
    throw InputError("", "memoryReference", fmt::format("'{}' is no address", text), "0xADDRESS");
}

class Server {
  public:
    Server(int in, int out) : channel_(in, out) {}

    int serve() {
        while (!left_) {
            std::optional<json> message = next();
            if (!message) return 0;
            handle(*message);
            if (resume_) run();
        }
        return 0;
    }

  private:
    using Request = json (Server::*)(const json& arguments);

    std::optional<json> next() {
        if (!waiting_.empty()) {
            json message = std::move(waiting_.front());
            waiting_.pop_front();
            return message;
        }
        return channel_.receive(true);
    }

    static const std::map<std::string, Request>& requests() {
        static const std::map<std::string, Request> all{
            {"initialize", &Server::initialize},
            {"launch", &Server::launch},
            {"setBreakpoints", &Server::set_breakpoints},
            {"setFunctionBreakpoints", &Server::set_function_breakpoints},
            {"setInstructionBreakpoints", &Server::set_instruction_breakpoints},
            {"dataBreakpointInfo", &Server::data_breakpoint_info},
            {"setDataBreakpoints", &Server::set_data_breakpoints},
            {"setExceptionBreakpoints", &Server::nothing},
            {"configurationDone", &Server::configuration_done},
            {"threads", &Server::threads},
            {"stackTrace", &Server::trace},
            {"scopes", &Server::scopes},
            {"variables", &Server::list_variables},
            {"evaluate", &Server::evaluate},
            {"disassemble", &Server::disassemble},
            {"readMemory", &Server::read_memory},
            {"continue", &Server::go_on},
            {"next", &Server::step_over},
            {"stepIn", &Server::step_in},
            {"stepOut", &Server::step_out},
            {"stepBack", &Server::step_back},
            {"reverseContinue", &Server::reverse},
            {"pause", &Server::pause},
            {"disconnect", &Server::leave},
            {"terminate", &Server::leave},
        };
        return all;
    }

    void handle(const json& message) {
        const auto text = [&](const char* name) {
            const auto found = message.find(name);
            return found != message.end() && found->is_string() ? found->get<std::string>() : std::string();
        };
        if (text("type") != "request")
            return;  // responses to what was never asked, and events, mean nothing here
        const std::string command = text("command");
        json response{{"type", "response"}, {"seq", seq_++}, {"command", command}, {"success", true}};
        response["request_seq"] = message.contains("seq") ? message["seq"] : json(0);
        const json arguments = message.contains("arguments") && message["arguments"].is_object()
                                   ? message["arguments"]
                                   : json::object();
        after_ = nullptr;
        try {
            const auto found = requests().find(command);
            if (found == requests().end()) {
                std::vector<std::string_view> names;
                for (const auto& [name, act] : requests())
                    names.push_back(name);
                throw InputError("", "", fmt::format("no request '{}'", command),
                                 "one of the protocol" + did_you_mean(command, names));
            }
            json body = (this->*found->second)(arguments);
            if (!body.is_null()) response["body"] = std::move(body);
        } catch (const InputError& error) {
            response["success"] = false;
            response["message"] = error.what();
            response["body"] = {{"error", {{"id", 1}, {"format", error.what()}, {"showUser", true}}}};
            resume_ = nullptr;
            after_ = nullptr;
        }
        channel_.send(response);
        if (after_) after_();
    }

    void event(const char* name, json body = json::object()) {
        channel_.send({{"type", "event"}, {"seq", seq_++}, {"event", name}, {"body", std::move(body)}});
    }

    Session& session() {
        if (!session_) throw InputError("", "", "nothing is being debugged", "launch first");
        return *session_;
    }

    // Beginning.

    json initialize(const json& arguments) {
        lines_from_ = argument<bool>(arguments, "linesStartAt1", true, "true or false") ? 1 : 0;
        return {{"supportsConfigurationDoneRequest", true},
                {"supportsFunctionBreakpoints", true},
                {"supportsInstructionBreakpoints", true},
                {"supportsDataBreakpoints", true},
                {"supportsStepBack", true},
                {"supportsEvaluateForHovers", true},
                {"supportsDisassembleRequest", true},
                {"supportsReadMemoryRequest", true},
                {"supportsTerminateRequest", true}};
    }

    json launch(const json& arguments) {
        if (session_)
            throw InputError("", "launch", "a program is being debugged already", "one session for each");
        DebuggerOptions options;
        options.exec.image = argument<std::string>(arguments, "program", "", "the image's file");
        if (options.exec.image.empty()) throw InputError("", "program", "missing", "the image's file");
        options.exec.bench.board = argument<std::string>(arguments, "board", "", "pic, rab or tam");
        options.exec.bench.mcu = argument<std::string>(arguments, "mcu", "", "a chip's name");
        if (!options.exec.bench.board.empty() && !options.exec.bench.mcu.empty())
            throw InputError("", "mcu", "a chip alone and a board exclude each other", "one of the two");
        for (const std::string& folder :
             argument<std::vector<std::string>>(arguments, "sources", {}, "a list of folders"))
            options.sources.emplace_back(folder);
        for (const char* name : {"uart1", "uart2"})
            if (const auto end = argument<std::string>(arguments, name, "", "pty, tcp:PORT or script:FILE");
                !end.empty())
                options.exec.uart[name[4] - '1'] = end;
        options.exec.stimulus = argument<std::string>(arguments, "stimulus", "", "a file");
        stop_on_entry_ = argument<bool>(arguments, "stopOnEntry", false, "true or false");
        complete_options(options);
        session_ = std::make_unique<Session>(options);
        session_->debugged().wants_stop = [this] { return wanted(); };
        after_ = [this] { event("initialized"); };
        return nullptr;
    }

    json configuration_done(const json&) {
        static_cast<void>(session());
        if (stop_on_entry_)
            after_ = [this] { report({Stop::Why::Step}, "entry"); };
        else
            will([this] { return session().motion().run(); }, nullptr, true);
        return nullptr;
    }

    // What stops it.

    /// Replaces those of one kind ("function", "lamp.c"): each is added by `add`, and described for the
    /// editor.
    json replace(const std::string& kind, const json& wanted, const std::function<int(const json&)>& add) {
        for (const int number : points_[kind])
            session().remove(number);
        points_[kind].clear();
        json list = json::array();
        for (const json& one : wanted) {
            try {
                const int number = add(one);
                points_[kind].push_back(number);
                json made{{"id", number}, {"verified", true}};
                const Point& point = session().points().at(number);
                if (!point.places.empty()) {
                    const std::uint32_t pc = point.places.front();
                    made["instructionReference"] = fmt::format("0x{:06x}", pc);
                    if (const SourceLine line = session().program().line_of(pc); line.line != 0) {
                        made["line"] = static_cast<int>(line.line) - 1 + lines_from_;
                        made["source"] = source(session().program(), line.file);
                    }
                }
                list.push_back(made);
            } catch (const InputError& error) {
                list.push_back({{"verified", false}, {"message", error.what()}});
            }
        }
        return {{"breakpoints", list}};
    }

    static json list_of(const json& arguments, const char* name) {
        const auto found = arguments.find(name);
        return found != arguments.end() && found->is_array() ? *found : json::array();
    }

    json set_breakpoints(const json& arguments) {
        const json given = argument<json>(arguments, "source", json::object(), "a source");
        std::string file = argument<std::string>(given, "path", "", "a path");
        if (file.empty()) file = argument<std::string>(given, "name", "", "a name");
        file = file.substr(file.find_last_of("/\\") + 1);
        if (file.empty()) throw InputError("", "source", "has neither path nor name", "a source file");
        return replace("source " + file, list_of(arguments, "breakpoints"), [&](const json& one) {
            const int line = argument<int>(one, "line", -1, "a line") + 1 - lines_from_;
            if (line < 1) throw InputError("", "line", "missing", "a line's number");
            return session().add_break(fmt::format("{}:{}", file, line), {}, false);
        });
    }

    json set_function_breakpoints(const json& arguments) {
        return replace("function", list_of(arguments, "breakpoints"), [&](const json& one) {
            return session().add_break(argument<std::string>(one, "name", "", "a function"), {}, false);
        });
    }

    json set_instruction_breakpoints(const json& arguments) {
        return replace("instruction", list_of(arguments, "breakpoints"), [&](const json& one) {
            const json place{
                {"memoryReference", argument<std::string>(one, "instructionReference", "", "an address")}};
            const auto offset = argument<int>(one, "offset", 0, "a number");
            return session().add_break(
                fmt::format("0x{:x}", static_cast<std::int64_t>(reference(place)) + offset), {}, false);
        });
    }

    json data_breakpoint_info(const json& arguments) {
        const auto name = argument<std::string>(arguments, "name", "", "a name");
        try {
            if (place_of(name, session().chip(), session().program()).core)
                throw InputError("", "", "a register of the core", "");
            return {{"dataId", name}, {"description", name}, {"accessTypes", {"read", "write", "readWrite"}}};
        } catch (const InputError& error) {
            return {{"dataId", nullptr}, {"description", error.what()}};
        }
    }

    json set_data_breakpoints(const json& arguments) {
        return replace("data", list_of(arguments, "breakpoints"), [&](const json& one) {
            const auto kind = argument<std::string>(one, "accessType", "write", "read, write or readWrite");
            return session().add_watch(argument<std::string>(one, "dataId", "", "a variable or register"),
                                       kind == "read"        ? "r"
                                       : kind == "readWrite" ? "rw"
                                                             : "w");
        });
    }

    json nothing(const json&) { return {{"breakpoints", json::array()}}; }

    // What is seen.

    json threads(const json&) {
        return {{"threads",
                 {{{"id", kThread}, {"name", std::string(session_ ? session_->chip().name() : "chip")}}}}};
    }

    json trace(const json& arguments) {
        json found = stack_trace(session(), argument<std::size_t>(arguments, "startFrame", 0, "a number"),
                                 argument<std::size_t>(arguments, "levels", 0, "a number"));
        if (lines_from_ == 0)
            for (json& frame : found["stackFrames"])
                if (frame["line"].get<int>() > 0) frame["line"] = frame["line"].get<int>() - 1;
        return found;
    }

    json scopes(const json&) {
        static_cast<void>(session());
        return {{"scopes",
                 {{{"name", "Variables"}, {"variablesReference", kVariablesScope}, {"expensive", false}},
                  {{"name", "Core registers"},
                   {"presentationHint", "registers"},
                   {"variablesReference", kCoreScope},
                   {"expensive", false}},
                  {{"name", "Registers"},
                   {"presentationHint", "registers"},
                   {"variablesReference", kSpecialScope},
                   {"expensive", true}}}}};
    }

    json list_variables(const json& arguments) {
        return variables(session(), argument<int>(arguments, "variablesReference", 0, "a number"));
    }

    json evaluate(const json& arguments) {
        return evaluated(session(), argument<std::string>(arguments, "expression", "", "a text"));
    }

    json disassemble(const json& arguments) {
        const auto count = argument<std::int64_t>(arguments, "instructionCount", 0, "a number");
        const auto offset = argument<std::int64_t>(arguments, "instructionOffset", 0, "a number");
        if (count < 0 || count > kMostInstructions || offset < -kMostInstructions ||
            offset > kMostInstructions)
            throw InputError("", "disassemble", "too many instructions",
                             fmt::format("at most {}", kMostInstructions));
        const auto address = static_cast<std::int64_t>(reference(arguments)) +
                             argument<std::int64_t>(arguments, "offset", 0, "a number");
        return disassembled(session(), static_cast<std::uint32_t>(address) & ~1u, offset, count);
    }

    json read_memory(const json& arguments) {
        const auto count = argument<std::uint32_t>(arguments, "count", 0, "a number of bytes");
        if (count > kMostReadMemory)
            throw InputError("", "count", "too many bytes", fmt::format("at most {}", kMostReadMemory));
        const auto address = static_cast<std::int64_t>(reference(arguments)) +
                             argument<std::int64_t>(arguments, "offset", 0, "a number");
        return memory(session(), static_cast<std::uint32_t>(address), count);
    }

    // Going on.

    /// `again`: what was interrupted for another request is taken up again after it.
    json will(std::function<Stop()> how, json body = nullptr, bool again = false) {
        if (session().over()) throw InputError("", "", "the run is over", "launch again");
        resume_ = std::move(how);
        again_ = again;
        return body;
    }
    static bool by_instruction(const json& arguments) {
        return argument<std::string>(arguments, "granularity", "statement", "a word") == "instruction";
    }
    json go_on(const json&) {
        return will([this] { return session().motion().run(); }, {{"allThreadsContinued", true}}, true);
    }
    json step_over(const json& arguments) {
        const bool one = by_instruction(arguments);
        return will([this, one] {
            return one ? session().motion().next_instruction() : session().motion().step_line(false);
        });
    }
    json step_in(const json& arguments) {
        const bool one = by_instruction(arguments);
        return will([this, one] {
            return one ? session().motion().step_instruction() : session().motion().step_line(true);
        });
    }
    json step_out(const json&) {
        return will([this] {
            const Stop stop = session().motion().finish(1);
            return stop.why == Stop::Why::Begin ? Stop{Stop::Why::Step} : stop;  // there is no caller
        });
    }
    json step_back(const json& arguments) {
        const bool one = by_instruction(arguments);
        return will([this, one] {
            return one ? session().motion().back_instruction() : session().motion().back_line(false);
        });
    }
    json reverse(const json&) {
        return will([this] { return session().motion().back_run(); }, nullptr, true);
    }
    json pause(const json&) {
        paused_ = true;
        return nullptr;
    }
    json leave(const json&) {
        left_ = true;
        after_ = [this] {
            if (!terminated_) event("terminated");
            if (session_) session_->finish();
        };
        return nullptr;
    }

    /// While the program runs: a request that wants it to stand still. `threads` is answered at once.
    bool wanted() {
        while (std::optional<json> message = channel_.receive(false)) {
            if (message->contains("command") && (*message)["command"] == "threads")
                handle_inside(*message);
            else
                waiting_.push_back(std::move(*message));
        }
        return channel_.closed() || !waiting_.empty();
    }
    void handle_inside(const json& message) {
        auto kept = std::move(resume_);
        handle(message);
        resume_ = std::move(kept);
    }

    void run() {
        while (resume_) {
            const std::function<Stop()> how = std::move(resume_);
            const bool again = again_;
            resume_ = nullptr;
            paused_ = false;
            const Stop stop = how();
            if (stop.why != Stop::Why::Interrupt) {
                report(stop, nullptr);
                return;
            }
            if (channel_.closed()) {
                left_ = true;
                return;
            }
            // Requests that came meanwhile: breakpoints and the like are done, and the program goes on.
            while (!waiting_.empty() && !left_ && !paused_) {
                json message = std::move(waiting_.front());
                waiting_.pop_front();
                handle(message);
            }
            if (left_) return;
            if (paused_ || (!resume_ && !again)) {  // a step is not taken up in the middle
                report({Stop::Why::Interrupt}, "pause");
                return;
            }
            if (!resume_) will(how, nullptr, true);
        }
    }

    void report(const Stop& stop, const char* reason) {
        if (stop.why == Stop::Why::End) {
            session().end();
            terminated_ = true;
            event("exited", {{"exitCode", 0}});
            event("terminated");
            return;
        }
        const std::vector<int> hits = session().hit(stop);
        json body{{"threadId", kThread}, {"allThreadsStopped", true}};
        body["reason"] = reason != nullptr                                             ? reason
                         : stop.why == Stop::Why::Watch || stop.why == Stop::Why::Bits ? "data breakpoint"
                         : stop.why == Stop::Why::Break                                ? "breakpoint"
                         : stop.why == Stop::Why::Begin                                ? "entry"
                                                                                       : "step";
        if (!hits.empty()) body["hitBreakpointIds"] = hits;
        event("stopped", std::move(body));
    }

    DapChannel channel_;
    std::deque<json> waiting_;
    std::unique_ptr<Session> session_;
    std::map<std::string, std::vector<int>> points_;
    std::function<Stop()> resume_;
    std::function<void()> after_;
    int seq_ = 1;
    int lines_from_ = 1;
    bool stop_on_entry_ = false;
    bool again_ = false;
    bool paused_ = false;
    bool left_ = false;
    bool terminated_ = false;
};

}  // namespace

int serve_dap(int in, int out) {
    std::signal(SIGPIPE, SIG_IGN);
    return Server(in, out).serve();
}

}  // namespace puckloop::exec::debugger
