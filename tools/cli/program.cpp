#include "tools/cli/program.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "base/version/version.h"
#include "tools/cli/help_text.h"
#include "tools/cli/option_sections.h"
#include "tools/cli/usage_error.h"

#include <CLI/CLI.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace puckloop::tools {

namespace {

/// Whoever started us may have closed the standard descriptors, which then would become sockets and logs, or
/// ignored the end of child processes, which is how failures of nodes are noticed.
void restore_surroundings() {
    int descriptor = 0;
    do
        descriptor = ::open("/dev/null", O_RDWR);
    while (descriptor >= 0 && descriptor <= STDERR_FILENO);
    if (descriptor >= 0) ::close(descriptor);
    std::signal(SIGCHLD, SIG_DFL);
}

/// `help run` is `run --help`, `help` alone `--help`.
std::vector<std::string> without_help_command(std::vector<std::string> words) {
    if (words.empty() || words.front() != "help") return words;
    if (words.size() > 1 && words.back().starts_with("-")) return words;  // of the command `help` itself
    words.erase(words.begin());
    words.emplace_back("--help");
    return words;
}

void print_error(std::string_view text) {
    std::fprintf(stderr, "puckloop: %s\n", plain_lines(text, kLongestMessage).c_str());
}

/// What nothing catches, as of a thread that gets no memory, has no library's words and no core.
[[noreturn]] void end_uncaught() {
    const char* text = "an internal error that nothing catches";
    std::string reason;
    if (const std::exception_ptr uncaught = std::current_exception()) {
        try {
            std::rethrow_exception(uncaught);
        } catch (const std::bad_alloc& error) {
            reason = reason_of(error);
            text = reason.c_str();
        } catch (const std::exception& error) {
            reason = "internal error: " + reason_of(error);
            text = reason.c_str();
        } catch (...) {
        }
    }
    std::fprintf(stderr, "puckloop: %s\n", text);
    std::_Exit(1);
}

/// `status`, if all that was printed has been written; else one line, and 1.
int after_output(int status) {
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
    std::fputs("puckloop: standard output: cannot be written\n", stderr);
    return 1;
}

}  // namespace

int run_program(std::span<const DeclareCommand> commands, std::vector<std::string> words,
                std::span<const Heading> headings, const std::string& name) {
    restore_surroundings();
    std::set_terminate(end_uncaught);
    CLI::App app{"puckloop: real robot firmware, without the robot"};
    app.name(name);
    app.require_subcommand(1);
    app.formatter(std::make_shared<HelpText>());
    app.set_version_flag("--version", name + " " + version_text(), "print version and commit");
    int status = 0;
    Command root(app);
    for (const DeclareCommand declare : commands)
        declare(root, status);
    // Now: a command would take it over.
    app.footer(name + " help COMMAND lists its options. First steps: puckloop list, puckloop new NAME.\n"
                      "Documentation: /usr/share/doc/puckloop/docs, or docs/ of the sources.");
    for (CLI::App* command : app.get_subcommands({})) {
        for (const Heading& one : headings)
            if (one.command == command->get_name()) command->group(std::string(one.heading));
        set_sections(*command);
    }
    words = without_help_command(std::move(words));
    try {
        std::reverse(words.begin(), words.end());  // CLI11 takes them last first
        app.parse(words);
        return after_output(status);
    } catch (const CLI::CallForHelp& error) {
        if (!app.get_subcommands().empty() || app.remaining().empty()) return after_output(app.exit(error));
        // `puckloop snapshott --help`: help on what there is not
        const CLI::ExtrasError unknown(name, app.remaining());
        print_error(usage_error(app, unknown));
        return 2;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return after_output(app.exit(error));  // --version
        print_error(usage_error(app, error));
        return 2;
    } catch (const InputError& error) {
        print_error(error.what());
        return 2;
    } catch (const RunError& error) {
        print_error(error.what());
        return 1;
    } catch (const std::filesystem::filesystem_error& error) {
        print_error(error.path1().string() + ": " + error.code().message());
        return 1;
    } catch (const std::system_error& error) {
        const std::string_view text = error.what();
        const bool output = text.starts_with("cannot write to file");  // fmt::print on a full disk
        // What a thread that cannot be made says: of it, too, memory is the usual lack.
        const bool lack = error.code() == std::errc::resource_unavailable_try_again;
        print_error(output ? "standard output: " + std::string(text)
                    : lack ? "not enough memory, or processes are limited to less (ulimit -v, -u)"
                           : error.code().message());
        return 1;
    } catch (const std::bad_alloc& error) {
        print_error(reason_of(error));
        return 1;
    } catch (const std::exception& error) {
        print_error("internal error: " + reason_of(error));
        return 1;
    }
}

}  // namespace puckloop::tools
