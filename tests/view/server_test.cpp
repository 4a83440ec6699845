// `puckloop view` as a process: what it answers, to whom, and what it refuses.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/view/client.h"

#include <catch2/catch.hpp>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <memory>
#include <random>
#include <vector>

using namespace puckloop::tests;
namespace fs = std::filesystem;

namespace {

/// A run of a moment.
fs::path recorded(const Workbench& bench) {
    REQUIRE(bench.run("o", {PUCKLOOP_SOURCE "/scenarios/hello.toml", "--in-process", "--duration", "1.5"})
                .status == 0);
    return bench.out("o");
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a run's folder is served until Ctrl-C, and what was refused is counted") {
    const Workbench bench;
    const fs::path folder = recorded(bench);
    CHECK(fs::exists(folder / "arena.json"));
    const Viewer viewer = start_viewer(folder, bench.folder() / "s");
    const std::string page = viewer.get("");
    CHECK(status_of(page) == "200");
    for (const char* header :
         {"Content-Security-Policy: default-src 'none'", "X-Content-Type-Options: nosniff",
          "X-Frame-Options: DENY", "Referrer-Policy: no-referrer", "Cache-Control: no-store",
          "Cross-Origin-Resource-Policy: same-origin"}) {
        INFO(header);
        CHECK(has(page, header));
    }
    CHECK(has(viewer.get("head"), "\"scenario\":\"hello.toml\""));
    CHECK_FALSE(has(viewer.get("head"), PUCKLOOP_SOURCE));  // no path of this machine
    CHECK(status_of(viewer.get("poses")) == "200");
    CHECK(status_of(viewer.get("trace.csv")) == "404");
    CHECK(status_of(viewer.get("../report.json")) == "404");
    viewer.process->signal(SIGINT);
    const Ended ended = viewer.process->wait(10);
    CHECK(ended.status == 0);
    CHECK(has(ended.out, "4 requests answered; refused: 2 (unknown names)"));
    CHECK(ended.err.empty());
    CHECK(Connection(viewer.port).id() == -1);
}

TEST_CASE("a WebSocket is a page's of this server, at the one address that has one") {
    const Workbench bench;
    const Viewer viewer = start_viewer(recorded(bench), bench.folder() / "s");
    const auto upgrade = [&](const std::string& rest, const std::string& origin) {
        const Connection connection(viewer.port);
        connection.send(viewer.request(rest, origin + "Upgrade: websocket\r\nConnection: Upgrade\r\n"
                                                      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                                                      "Sec-WebSocket-Version: 13\r\n"));
        return status_of(connection.answer());
    };
    const std::string own = "Origin: http://" + viewer.host() + "\r\n";
    CHECK(upgrade("live", "") == "403");
    CHECK(upgrade("live", "Origin: http://evil.example\r\n") == "403");
    // A recorded run has nothing new to send.
    CHECK(upgrade("live", own) == "404");
    CHECK(upgrade("head", own) == "404");
}

TEST_CASE("other hosts, origins, tokens and methods are refused") {
    const Workbench bench;
    const Viewer viewer = start_viewer(recorded(bench), bench.folder() / "s");
    const auto ask = [&](const std::string& text) {
        const Connection connection(viewer.port);
        connection.send(text);
        const std::string answer = connection.answer();
        CHECK_FALSE(has(answer, viewer.token));
        CHECK_FALSE(has(answer, "hello.toml"));
        return status_of(answer);
    };
    const std::string target = "/" + viewer.token + "/head", host = "Host: " + viewer.host() + "\r\n";
    CHECK(ask("GET " + target + " HTTP/1.1\r\nHost: evil.example\r\n\r\n") == "403");
    CHECK(ask("GET " + target + " HTTP/1.1\r\n\r\n") == "400");
    CHECK(ask("GET " + target + " HTTP/1.1\r\n" + host + host + "\r\n") == "400");
    CHECK(ask("GET " + target + " HTTP/1.1\r\n" + host + "Origin: http://evil.example\r\n\r\n") == "403");
    CHECK(ask("GET " + target + " HTTP/1.1\r\n" + host + "Origin: null\r\n\r\n") == "403");
    CHECK(ask("GET /head HTTP/1.1\r\n" + host + "\r\n") == "404");
    CHECK(ask("GET / HTTP/1.1\r\n" + host + "\r\n") == "404");
    CHECK(ask("GET /" + std::string(32, '0') + "/head HTTP/1.1\r\n" + host + "\r\n") == "404");
    CHECK(ask("POST " + target + " HTTP/1.1\r\n" + host + "Content-Length: 0\r\n\r\n") == "405");
    CHECK(ask("POST " + target + " HTTP/1.1\r\n" + host + "Content-Length: 5\r\n\r\nhello") == "405");
    CHECK(ask("POST " + target + " HTTP/1.1\r\n" + host + "Content-Length: 20000\r\n\r\n" +
              std::string(20'000, 'x')) == "413");
    CHECK(ask("GET http://evil.example" + target + " HTTP/1.1\r\n" + host + "\r\n") == "404");
    CHECK(ask("rubbish\r\n\r\n") == "400");
    CHECK(ask("GET " + target + " HTTP/1.1\r\n" + host + "X: " + std::string(20'000, 'x') + "\r\n\r\n") ==
          "431");
    CHECK(ask("GET /" + std::string(20'000, 'x') + " HTTP/1.1\r\n" + host + "\r\n") == "431");
    // The page's own requests go on.
    const Connection own(viewer.port);
    own.send(viewer.request("head", "Origin: http://" + viewer.host() + "\r\n"));
    CHECK(status_of(own.answer()) == "200");
    viewer.process->signal(SIGTERM);
    const Ended ended = viewer.process->wait(10);
    CHECK(ended.status == 0);
    for (const char* part :
         {"another host", "another origin", "wrong token", "another method", "malformed"}) {
        INFO(part);
        CHECK(has(ended.out, part));
    }
}

TEST_CASE("only this machine's loopback is listened to") {
    const Workbench bench;
    const Viewer viewer = start_viewer(recorded(bench), bench.folder() / "s");
    std::ifstream sockets("/proc/net/tcp");
    char port[16];
    std::snprintf(port, sizeof port, ":%04X", viewer.port);
    int listening = 0;
    for (std::string line; std::getline(sockets, line);)
        if (has(line, port) && has(line, " 0A ")) {  // state LISTEN
            ++listening;
            CHECK(has(line, std::string("0100007F") + port));
        }
    CHECK(listening == 1);
}

TEST_CASE("random bytes are answered with an error or closed, and others are served meanwhile") {
    const Workbench bench;
    const Viewer viewer = start_viewer(recorded(bench), bench.folder() / "s");
    std::mt19937 random(Catch::rngSeed());
    for (int i = 0; i < 60; ++i) {
        const Connection connection(viewer.port);
        std::string bytes = viewer.request("head");
        for (int k = 0; k < 6; ++k)
            switch (random() % 3) {
            case 0:
                bytes[random() % bytes.size()] = static_cast<char>(random());
                break;
            case 1:
                bytes.insert(random() % bytes.size(),
                             std::string(random() % 300, static_cast<char>(random())));
                break;
            default:
                bytes.erase(random() % bytes.size(), random() % 8);
            }
        connection.send(bytes);
        if (i % 10 == 0) CHECK(status_of(viewer.get("status")) == "200");
    }
    CHECK(status_of(viewer.get("head")) == "200");
    viewer.process->signal(SIGINT);
    CHECK(viewer.process->wait(10).status == 0);
}

TEST_CASE("a thousand connections and slow readers do not stop it") {
    const Workbench bench;
    const Viewer viewer = start_viewer(recorded(bench), bench.folder() / "s");
    // Asks, and never reads.
    std::vector<std::unique_ptr<Connection>> slow;
    for (int i = 0; i < 20; ++i) {
        slow.push_back(std::make_unique<Connection>(viewer.port));
        REQUIRE(slow.back()->id() >= 0);
        for (int k = 0; k < 20; ++k)
            slow.back()->send(viewer.request("page.js"));
    }
    CHECK(status_of(viewer.get("head")) == "200");
    int closed = 0;
    {
        std::vector<std::unique_ptr<Connection>> many;
        for (int i = 0; i < 1000; ++i) {
            many.push_back(std::make_unique<Connection>(viewer.port));
            if (many.back()->id() >= 0 && many.size() > 100 && i % 100 == 99)
                closed += many.back()->closed(5) ? 1 : 0;
        }
        CHECK(closed >= 8);  // those above the limit are closed at once
    }
    // Theirs have gone: there is room again.
    std::string answer;
    for (const double end = wall_seconds() + 20; status_of(answer) != "200" && wall_seconds() < end;)
        answer = viewer.get("head");
    CHECK(status_of(answer) == "200");
    viewer.process->signal(SIGINT);
    const Ended ended = viewer.process->wait(10);
    CHECK(ended.status == 0);
    CHECK(has(ended.out, "too many connections"));
}

TEST_CASE("a request that does not come to its end is given up") {
    const Workbench bench;
    const Viewer viewer = start_viewer(recorded(bench), bench.folder() / "s");
    const Connection silent(viewer.port), half(viewer.port);
    half.send("GET /" + viewer.token + "/head HTTP/1.1\r\nHost:");
    CHECK(silent.closed(25));
    CHECK(half.closed(5));
}

TEST_CASE("what cannot be viewed is one line with the remedy") {
    const Workbench bench;
    check_one_line(bench.puckloop({"view", bench.out("nowhere").string()}), 2,
                   {"nowhere", "no such folder", "puckloop run"});
    const fs::path folder = recorded(bench);
    const Viewer viewer = start_viewer(folder, bench.folder() / "s");
    check_one_line(bench.puckloop({"view", folder.string(), "--port", std::to_string(viewer.port)}), 2,
                   {"--port", std::to_string(viewer.port), "another port, or 0"});
    check_one_line(
        bench.puckloop({"view", folder.string(), "--export", (bench.folder() / "no/where.html").string()}), 2,
        {"where.html", "cannot write"});
    const Ended exported =
        bench.puckloop({"view", folder.string(), "--export", bench.out("page.html").string()});
    CHECK(exported.status == 0);
    CHECK(has(exported.out, "page.html: "));
    CHECK(has(text_of(bench.out("page.html")), "data-events"));
    bench.file("o/report.json", "{\"format\":77}");
    check_one_line(bench.puckloop({"view", folder.string()}), 2,
                   {"report.json", "format", "is 77", "run the scenario again"});
}
