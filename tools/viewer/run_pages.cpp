#include "tools/viewer/run_pages.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/pages/html_page.h"
#include "base/pages/svg.h"
#include "base/plain_text.h"
#include "campaigns/engine/case_run.h"
#include "campaigns/engine/html.h"
#include "campaigns/engine/prefixes.h"
#include "campaigns/experiment/again.h"
#include "campaigns/jobs/own_process.h"
#include "cosim/core/time.h"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace puckloop::tools {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kPrefix = "run/";
constexpr const char* kHtml = "text/html; charset=utf-8";

ManyRuns of_campaign(const fs::path& folder) {
    const faults::Results results = faults::read_results(folder);
    const scenarios::Scenario scenario = faults::scenario_of(results.campaign);
    ManyRuns many{
        .what = "case",
        .report = faults::html_text(
            results,
            [&](const faults::Case& one) {
                const cosim::Time begin = faults::first_begin(results.campaign, scenario, one);
                return run_page(one.id, begin == cosim::kNever ? 0.0 : cosim::to_seconds(begin));
            }),
        .runs = {},
        .kept = [](int) { return fs::path(); },
        .folder = [out = results.out](int id) { return out / "replay" / std::to_string(id); },
        .again =
            [out = results.out](int id) {
                return std::vector<std::string>{"faults", "replay", out.string(), std::to_string(id)};
            }};
    for (const faults::CaseResult& result : results.results)
        many.runs.insert(result.one.id);
    return many;
}

ManyRuns of_experiment(const fs::path& folder) {
    const swarm::Findings findings = swarm::read_findings(folder);
    const fs::path out = findings.out;
    ManyRuns many{
        .what = "run",
        .report = swarm::served_report(findings, [](const swarm::Run& run) { return run_page(run.id, 0.0); }),
        .runs = {},
        .kept = [out, keep = findings.experiment.keep](
                    int id) { return keep ? out / "runs" / std::to_string(id) : fs::path(); },
        .folder = [out](int id) { return out / "replay" / std::to_string(id); },
        .again =
            [out](int id) {
                return std::vector<std::string>{"experiment", out.string(), "--again", std::to_string(id)};
            }};
    for (const auto& [id, result] : findings.results)
        many.runs.insert(id);
    return many;
}

view::Content page_of(const std::string& title, const std::string& body, bool comes_again) {
    return {kHtml,
            html_head(title) + (comes_again ? "<meta http-equiv=\"refresh\" content=\"1\">\n" : "") + "<h1>" +
                escaped(title) + "</h1>\n" + body +
                "<p><a href=\"../../\">the report</a></p></body></html>\n",
            true};
}

}  // namespace

std::optional<ManyRuns> many_runs(const fs::path& folder) {
    std::error_code none;
    if (fs::exists(folder / "campaign.db", none)) return of_campaign(folder);
    if (fs::exists(folder / "experiment.db", none)) return of_experiment(folder);
    return std::nullopt;
}

std::string run_page(int run, double time_s) {
    return fmt::format("{}{}/?t={:.6f}", kPrefix, run, time_s);
}

/// The command that makes its files, with its output in a file.
class RunPages::Again {
  public:
    Again(std::vector<std::string> words, fs::path output) : output_(std::move(output)) {
        std::error_code none;
        if (fs::is_symlink(fs::symlink_status(output_.parent_path(), none)))
            throw RunError(output_.parent_path().string() +
                           ": is a link, and results are not written through it");
        make_folder(output_.parent_path());
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output_.c_str(),
                                         O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW, 0600);
        posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
        const int error = jobs::start_puckloop(std::move(words), actions, id_);
        if (error != 0) throw RunError(fmt::format("the run cannot be started: {}", std::strerror(error)));
    }
    ~Again() {
        if (id_ < 0) return;
        ::kill(id_, SIGTERM);
        while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
        }
    }
    Again(const Again&) = delete;
    Again& operator=(const Again&) = delete;

    bool over() {
        int waited = 0;
        if (id_ >= 0 && ::waitpid(id_, &waited, WNOHANG) == id_) {
            id_ = -1;
            done_ = WIFEXITED(waited) && WEXITSTATUS(waited) == 0;
        }
        return id_ < 0;
    }
    bool done() const { return done_; }
    /// What it has printed; the last of it.
    std::string output() const {
        constexpr std::size_t kMost = 4000;
        std::ifstream in(output_);
        std::string text{std::istreambuf_iterator<char>(in), {}};
        return text.size() > kMost ? text.substr(text.size() - kMost) : text;
    }

  private:
    fs::path output_;
    pid_t id_ = -1;
    bool done_ = false;
};

struct RunPages::Open {
    explicit Open(const fs::path& folder)
        : recording(folder), events(recording), answers(recording, events) {}
    view::Recording recording;
    view::EventReader events;
    view::Answers answers;
};

RunPages::RunPages(ManyRuns runs) : runs_(std::move(runs)) {}

RunPages::~RunPages() = default;

std::optional<view::Content> RunPages::get(std::string_view target) {
    if (target.empty()) return view::Content{kHtml, runs_.report, true};
    if (!target.starts_with(kPrefix)) return std::nullopt;
    target.remove_prefix(kPrefix.size());
    int run = 0;
    const auto [rest, error] = std::from_chars(target.data(), target.data() + target.size(), run);
    if (error != std::errc() || rest == target.data() + target.size() || *rest != '/' ||
        !runs_.runs.contains(run))
        return std::nullopt;
    target.remove_prefix(static_cast<std::size_t>(rest - target.data()) + 1);
    const bool page = target.empty() || target.starts_with('?');
    if (open_.find(run) == open_.end()) {
        if (!page) return std::nullopt;
        view::Content waiting = wait_for(run);
        if (open_.find(run) == open_.end()) return waiting;
    }
    return open_.at(run)->answers.get(target);
}

/// Notes which of those that were carried out again are over.
void RunPages::reap() {
    std::erase_if(again_, [this](const auto& one) {
        const auto& [run, again] = one;
        if (!again->over()) return false;
        if (again->done())
            carried_out_.insert(run);
        else
            failed_[run] = plain_lines(again->output(), kLongestMessage);
        return true;
    });
}

/// Opens it, or says why it is not open yet.
view::Content RunPages::wait_for(int run) {
    reap();
    const std::string name = fmt::format("{} {}", runs_.what, run);
    // Said once: who asks again has put it right, or waited for another viewer.
    if (const auto failed = failed_.extract(run))
        return page_of(
            name,
            fmt::format("<p>It cannot be shown:</p><pre>{}</pre>\n<p><a href=\"\">try again</a></p>\n",
                        escaped(failed.mapped())),
            false);
    fs::path folder = runs_.kept(run);
    try {
        if (folder.empty() || !fs::exists(folder)) {
            folder = runs_.folder(run);
            if (!carried_out_.contains(run)) {
                if (!again_.contains(run) && again_.size() < kMostAtOnce)
                    again_[run] = std::make_unique<Again>(runs_.again(run),
                                                          folder.parent_path() / fmt::format("{}.txt", run));
                return page_of(name, "<p>It is carried out again, and shown as soon as it is over.</p>\n",
                               true);
            }
        }
        open_[run] = std::make_unique<Open>(folder);
        opened_.push_back(run);
        if (opened_.size() > kMostOpen) {
            open_.erase(opened_.front());
            opened_.erase(opened_.begin());
        }
    } catch (const std::runtime_error& error) {
        failed_[run] = plain_lines(error.what(), kLongestMessage);
        return wait_for(run);
    }
    return {};
}

}  // namespace puckloop::tools
