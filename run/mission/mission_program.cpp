#include "run/mission/mission_program.h"

#include "base/error.h"
#include "base/json.h"
#include "base/plain_text.h"
#include "cosim/remote/processes/child_process.h"
#include "run/mission/mission_lines.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

namespace puckloop::tools {

namespace {

using std::chrono::steady_clock;

constexpr std::size_t kLongestAnswer = 1 << 20;   // bytes: some ten thousand commands
constexpr std::chrono::milliseconds kToDie{100};  // until how it ended is known, once its output is closed

/// A file descriptor that is closed.
class Descriptor {
  public:
    explicit Descriptor(int number = -1) : number_(number) {}
    ~Descriptor() { reset(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    void reset(int number = -1) {
        if (number_ >= 0) ::close(number_);
        number_ = number;
    }
    int number() const { return number_; }

  private:
    int number_;
};

class MissionProgram final : public physics::MissionSource {
  public:
    explicit MissionProgram(MissionProgramSpec spec) : spec_(std::move(spec)) {
        if (spec_.log.empty()) return;
        log_.reset(::open(spec_.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666));
        if (log_.number() < 0)
            throw RunError(fmt::format("cannot write {}: {}", spec_.log, std::strerror(errno)));
    }

    physics::MissionAnswer begin(const physics::World& world, const physics::TrackerSpec& tracker) override {
        for (const physics::Robot& robot : world.robots)
            names_.push_back(robot.name);
        start();
        return ask(begin_line(world, tracker, spec_.duration), "its beginning");
    }

    physics::MissionAnswer frame(const physics::TrackerFrame& frame,
                                 std::span<const physics::Journal::Entry> done,
                                 std::span<const physics::RefusedCommand> refused) override {
        ++frames_;
        return ask(frame_line(frame, names_, done, refused), fmt::format("frame {}", frame.number));
    }

    std::string end(double seconds) override {
        if (program_ && !failure_) ask(end_line(seconds), "the end");
        std::string why = failure_.value_or("");
        if (program_ && !failure_) {
            to_.reset();
            if (!program_->ended(milliseconds(spec_.timeout)))
                why = fmt::format("the mission program had not ended {:g} s after its last answer",
                                  spec_.timeout);
            else if (program_->ending() != "exited with status 0")
                why = "the mission program " + program_->ending();
        }
        program_.reset();
        nlohmann::ordered_json report{
            {"kind", "program"},
            {"score", score_ ? nlohmann::ordered_json(*score_) : nlohmann::ordered_json()},
            {"better", spec_.better},
            {"steps", frames_}};
        if (!why.empty()) report["why"] = why;
        return report.dump();
    }

  private:
    static std::chrono::milliseconds milliseconds(double seconds) {
        return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000.0));
    }

    void start() {
        // To it a socket, which needs no care for SIGPIPE; from it a pipe, which it can open as /dev/stdout.
        int to[2], from[2];
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, to) != 0)
            throw RunError(fmt::format("no line to the mission program: {}", std::strerror(errno)));
        to_.reset(to[0]);
        const Descriptor in(to[1]);
        if (::pipe2(from, O_CLOEXEC) != 0)
            throw RunError(fmt::format("no line from the mission program: {}", std::strerror(errno)));
        from_.reset(from[0]);
        const Descriptor out(from[1]);
        ::fcntl(from_.number(), F_SETFL, O_NONBLOCK);
        const std::string title = std::filesystem::path(spec_.command.front()).filename().string();
        program_ = std::make_unique<cosim::ChildProcess>(
            spec_.command, title, std::span<const int>{},
            cosim::ChildStreams{.in = in.number(), .out = out.number(), .error = log_.number()});
    }

    physics::MissionAnswer fail(std::string why) {
        failure_ = std::move(why);
        if (!spec_.log.empty() && std::filesystem::exists(spec_.log) &&
            std::filesystem::file_size(spec_.log) > 0)
            *failure_ += fmt::format("; what it wrote is in {}", spec_.log);
        return {.failed = true, .why = *failure_};
    }

    physics::MissionAnswer ask(const std::string& line, const std::string& what) {
        deadline_ = steady_clock::now() + milliseconds(spec_.timeout);
        std::optional<std::string> answer;
        if (const std::string problem = talk(line, answer); !problem.empty())
            return fail(fmt::format("the mission program {} at {}", problem, what));
        try {
            MissionReply reply = read_reply(*answer);
            if (reply.score) score_ = reply.score;
            return std::move(reply.answer);
        } catch (const InputError& error) {
            return fail(fmt::format("the mission program's answer to {}: {}", what, error.what()));
        }
    }

    /// Sends the line and waits for one; empty, or what went wrong. Both at once: a program may write more
    /// than fits before it reads.
    std::string talk(std::string_view rest, std::optional<std::string>& answer) {
        while (!rest.empty() || !(answer = take_line())) {
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline_ - steady_clock::now());
            if (left.count() <= 0) return fmt::format("gave no answer within {:g} s", spec_.timeout);
            pollfd wait[2] = {{from_.number(), POLLIN, 0}, {rest.empty() ? -1 : to_.number(), POLLOUT, 0}};
            if (::poll(wait, 2, static_cast<int>(left.count())) <= 0) continue;
            if (wait[1].revents != 0) {
                const ssize_t sent =
                    ::send(to_.number(), rest.data(), rest.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
                if (sent > 0) rest.remove_prefix(static_cast<std::size_t>(sent));
                if (sent < 0 && errno != EAGAIN && errno != EINTR)
                    rest = {};  // it reads no more, but may have answered
            }
            if (wait[0].revents != 0) {
                char piece[4096];
                const ssize_t got = ::read(from_.number(), piece, sizeof piece);
                if (got > 0)
                    heard_.append(piece, static_cast<std::size_t>(got));
                else if (got == 0 || (errno != EAGAIN && errno != EINTR))
                    return program_->ended(kToDie) ? program_->ending() : "closed its output";
            }
            if (heard_.size() > kLongestAnswer) return "answered more than 1 MiB";
        }
        return {};
    }

    std::optional<std::string> take_line() {
        const std::size_t end = heard_.find('\n');
        if (end == std::string::npos) return std::nullopt;
        std::string line = heard_.substr(0, end);
        heard_.erase(0, end + 1);
        return line;
    }

    MissionProgramSpec spec_;
    std::vector<std::string> names_;
    Descriptor log_, to_, from_;
    std::unique_ptr<cosim::ChildProcess> program_;
    steady_clock::time_point deadline_{};
    std::string heard_;
    std::optional<double> score_;
    std::uint64_t frames_ = 0;
    std::optional<std::string> failure_;
};

}  // namespace

std::unique_ptr<physics::MissionSource> make_mission_program(MissionProgramSpec spec) {
    return std::make_unique<MissionProgram>(std::move(spec));
}

}  // namespace puckloop::tools
