// avr-gdb as it is at an ATmega1284P, alone and as a board of a run: the sessions that docs/debugging.md
// shows, word for word.

#include "tests/debug/gdb_client.h"
#include "tests/exec/command.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <sstream>

using namespace puckloop;
using exec::text_of;
using exec::Workbench;

namespace {

/// The first block of docs/debugging.md behind `heading` that begins with "(gdb) target".
std::string documented_session(const std::string& heading) {
    const std::string text = text_of(std::string(PUCKLOOP_SOURCE) + "/docs/debugging.md");
    const std::size_t begin = text.find("\n    (gdb) target", text.find("\n" + heading));
    REQUIRE(begin != std::string::npos);
    std::istringstream lines(text.substr(begin + 1));
    std::string session;
    for (std::string line; std::getline(lines, line) && (line.empty() || line.starts_with("    "));)
        session += (line.empty() ? line : line.substr(4)) + "\n";
    return session;
}

/// Without empty lines and spaces at the end, which differ between a terminal and a batch.
std::string condensed(const std::string& text) {
    std::istringstream lines(text);
    std::string kept;
    for (std::string line; std::getline(lines, line);) {
        line.erase(line.find_last_not_of(" \t\r") + 1);
        if (!line.empty()) kept += line + "\n";
    }
    return kept;
}

bool can_debug() {
    if (std::string(PUCKLOOP_LAMP).empty() || std::system("command -v avr-gdb >/dev/null") != 0) {
        WARN("skipped: avr-gdb (package gdb-avr) or avr-gcc with avr-libc is not installed");
        return false;
    }
    if (std::system("avr-gdb -nx -batch -ex 'python import gdb' 2>&1 | grep -q Python") == 0) {
        WARN("skipped: avr-gdb writes warnings for want of its Python files (package gdb)");
        return false;
    }
    return true;
}

/// Has avr-gdb do at `server` what is documented; it ends by killing the run.
void check_session(const Workbench& bench, tests::GdbServer& server, const std::string& session) {
    std::string script = "set pagination off\nset confirm off\nset width 0\n";
    std::istringstream lines(session);
    int commands = 0;
    for (std::string line; std::getline(lines, line);) {
        constexpr std::string_view kPrompt = "(gdb) ";
        if (!line.starts_with(kPrompt)) continue;
        const std::string command = line.substr(kPrompt.size());
        script += "echo " + line + "\\n\n" +
                  (command == "target remote :4242" ? "target remote " + server.socket() : command) + "\n";
        ++commands;
    }
    REQUIRE(commands > 10);
    server.await_listening();
    const std::string out = bench.folder + "/gdb.out";
    const std::string command =
        "cd " + std::string(PUCKLOOP_SOURCE) + "/tests/debug/programs && timeout 120 avr-gdb -nx -batch -x " +
        bench.file("session.gdb", script) + " " + PUCKLOOP_LAMP + " >" + out + " 2>&1 </dev/null";
    CHECK(std::system(command.c_str()) == 0);
    CHECK(condensed(text_of(out)) == condensed(session));
    CHECK(server.wait() == 1);  // killed
}

}  // namespace

TEST_CASE("the documented session with avr-gdb") {
    if (!can_debug()) return;
    const Workbench bench;
    tests::GdbServer server(bench.folder, std::string("--mcu atmega1284p ") + PUCKLOOP_LAMP);
    check_session(bench, server, documented_session("## GDB: `exec --gdb PLACE`"));
}

TEST_CASE("the documented session with avr-gdb at a board of a run") {
    if (!can_debug()) return;
    const Workbench bench;
    const std::string scenario = bench.file("lamp.toml", std::string("[run]\nduration = \"2 s\"\n"
                                                                     "[arena]\nsize = [\"1 m\", \"1 m\"]\n"
                                                                     "[[tam]]\nname = \"tam0\"\n"
                                                                     "position = [\"0 m\", \"0 m\"]\n"
                                                                     "firmware = \"") +
                                                             PUCKLOOP_LAMP + "\"\n");
    tests::GdbServer server(bench.folder,
                            "run " + scenario + " --out " + bench.folder + "/out --gdb tam0.avr=unix:{}",
                            tests::GdbServer::Whole{});
    check_session(bench, server, documented_session("### A board of a run: `run --gdb NODE=PLACE`"));
}
