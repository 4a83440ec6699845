// Runs with a network: programs that know of no emulator between robots and hosts, the same in every
// placement; what a lossy network does to them; bad input.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/network/host_runs.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

using namespace puckloop::tests;
namespace fs = std::filesystem;

TEST_CASE("calls of sockets answer on a board as the host's kernel answers", "[network]") {
    const Workbench bench;
    const auto file = bench.file("calls.toml", hosts({{"alpha", python("calls.py")}}, "5 s"));
    const Ended ended = bench.run("o", {file, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const std::string log = log_of(bench, "o", "alpha");
    Process host(python_words("calls.py"), bench.folder());
    const Ended real = host.wait();
    INFO(real.err);
    const std::string common = "\ncommon\n";
    REQUIRE(log.find(common) != std::string::npos);
    CHECK(log.substr(log.find(common)) == real.out.substr(real.out.find(common)));
    for (const char* line : {"host alpha 10.0.0.254\n", "unknown gaierror -2\n", "wlan0 10.0.0.254\n",
                             "devices ['lo', 'wlan0']\n", "ways [['wlan0', '0000000A', '00000000']]\n",
                             "raw EPERM\n", "packet EPERM\n", "six EAFNOSUPPORT\n", "outside ENETUNREACH\n"})
        CHECK(log.find(line) != std::string::npos);
    const auto warnings = bench.report("o")["nodes"]["alpha.linux"]["warnings"];
    // Each once: the name, raw sockets, the family, two addresses, the port.
    CHECK(warnings.size() == 6);
    CHECK(std::count(warnings.begin(), warnings.end(), "the port 7100 is in use on this board") == 1);
    CHECK(std::count(warnings.begin(), warnings.end(), "the address 192.168.7.7 is outside of the network") ==
          1);
}

TEST_CASE("what servers and tools ask of sockets is as the host's kernel answers it", "[network]") {
    const Workbench bench;
    const auto file = bench.file("more.toml", hosts({{"alpha", python("more_calls.py")}}, "8 s"));
    const Ended ended = bench.run("o", {file, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    Process host(python_words("more_calls.py"), bench.folder());
    const Ended real = host.wait();
    INFO(real.err);
    CHECK(log_of(bench, "o", "alpha") == real.out);
    CHECK(real.out.ends_with("type EINVAL\n"));
    REQUIRE(bench.run("apart", {file}).status == 0);
    check_same_run(bench, "o", "apart");
}

TEST_CASE("robots talk to each other and to a server by Python's sockets, the same in every placement",
          "[network]") {
    const Workbench bench;
    std::string text = hosts({{"server", python("swarm_server.py")}}, "1.6 s");
    for (int i = 0; i < 3; ++i)
        text += fmt::format("[[robot]]\nposition = [\"{} cm\", \"0 cm\"]\n[robot.pic]\nfirmware = \"own\"\n"
                            "[robot.linux]\nprogram = {}\n",
                            20 * i - 20, python("swarm_robot.py"));
    check_everywhere(bench, bench.file("swarm.toml", text));
    for (int i = 0; i < 3; ++i) {
        const std::string log = log_of(bench, "o0", fmt::format("robot{}", i));
        INFO(log);
        CHECK(log.find(fmt::format("robot{} 10.0.0.{}", i, i + 1)) == 0);
        CHECK(count(log, "heard ") == 2 * 5);  // five calls of each of the others
        CHECK(log.find("server answers 5\n") != std::string::npos);
        CHECK(log.find("sensors 72\n") != std::string::npos);  // beside them the serial port
    }
    CHECK(count(log_of(bench, "o0", "server"), "robot") == 15);
    const auto network = bench.report("o0")["nodes"]["network"]["stations"];
    CHECK(network["server"]["address"] == "10.0.0.254");
    CHECK(network["robot0"]["packets_sent"] > 5);
}

TEST_CASE("by radio the same in every placement, and frames leave evidence", "[network]") {
    const Workbench bench;
    std::string text = hosts({{"server", python("swarm_server.py")}}, "1.6 s",
                             "mode = \"wifi\"\naccess_point = [\"30 cm\", \"30 cm\"]");
    for (int i = 0; i < 3; ++i)
        text += fmt::format("[[robot]]\nposition = [\"{} cm\", \"0 cm\"]\n[robot.pic]\nfirmware = \"own\"\n"
                            "[robot.linux]\nprogram = {}\n",
                            20 * i - 20, python("swarm_robot.py"));
    check_everywhere(bench, bench.file("wifi.toml", text));
    for (int i = 0; i < 3; ++i) {
        const std::string log = log_of(bench, "o0", fmt::format("robot{}", i));
        INFO(log);
        CHECK(log.find("server answers 5\n") != std::string::npos);
        CHECK(count(log, "heard ") >= 2 * 4);  // nobody acknowledges a broadcast: one may be lost
    }
    const auto network = bench.report("o0")["nodes"]["network"];
    CHECK(network["access_point"]["frames"] > 30);
    CHECK(network["stations"]["robot0"]["radio"]["acks"] > 5);
    CHECK_FALSE(network["stations"]["server"].contains("radio"));
    const std::string frames = text_of(bench.out("o0") / "wifi.csv");
    CHECK(frames.starts_with("time_s,end_s,from,to,kind,octets,rate_mbit_s,attempt,dbm,fate\n"));
    CHECK(count(frames, ",robot1,access_point,data,") > 5);
    CHECK(count(frames, ",access_point,robot1,ack,14,24,") > 5);
    // Faults of packets act here as well.
    const Ended ended = bench.run("far", {bench.file("far.toml", text).string(), "--in-process", "--fault",
                                          "partition node=network group=server begin=250ms end=650ms"});
    INFO(ended.err);
    CHECK(ended.status == 0);
    CHECK(bench.report("far")["faults"][0]["fired"] > 3);
}

TEST_CASE("a wall of the world is in the way of radios, and a mesh goes round it", "[network][mesh]") {
    const Workbench bench;
    const auto text = [&](const std::string& wifi, const std::string& more = "") {
        std::string all =
            fmt::format("[run]\nduration = \"3 s\"\n[arena]\nsize = [\"6 m\", \"6 m\"]\n[[wall]]\n"
                        "name = \"long\"\nfrom = [\"0 m\", \"-3 m\"]\nto = [\"0 m\", \"2 m\"]\n"
                        "[network]\nmode = \"wifi\"\n[network.wifi]\nshadowing = \"0 dB\"\n{}\n",
                        wifi);
        const std::vector<std::tuple<std::string, std::string, std::string>> hosts{
            {"server", "2 m\", \"-2 m", python("echo_server.py")},
            {"client", "-2 m\", \"-2 m", python("echo_client.py")},
            {"between", "0 m\", \"2.5 m", "[\"true\"]"}};
        for (const auto& [name, place, program] : hosts)
            all += fmt::format("[[host]]\nname = \"{}\"\nposition = [\"{}\"]\nprogram = {}\n", name, place,
                               program);
        return all + more;
    };
    const auto answers = [&](const std::string& name, const std::string& scenario) {
        const Ended ended = bench.run(name, {bench.file(name + ".toml", scenario), "--in-process"});
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        return count(log_of(bench, name, "client"), "answer ");
    };
    // 4 m: -43 dBm; through the wall 60 dB less.
    CHECK(answers("open", text("")) == 20);
    CHECK(answers("walled", text("wall_loss = \"60 dB\"")) == 0);
    // It goes at 1.55 s, and a heavy box comes at 2.05 s: those of 1.6 to 2.0 s are answered.
    CHECK(
        answers("removed", text("wall_loss = \"60 dB\"\nthing_loss = \"60 dB\"",
                                "[[event]]\nat = \"1.55 s\"\nremove = \"long\"\n[[event]]\nat = \"2.05 s\"\n"
                                "add = \"box\"\nname = \"new\"\ncentre = [\"1 m\", \"-2 m\"]\n"
                                "size = [\"1 m\", \"1 m\", \"1 m\"]\nmass = \"1 kg\"\n")) == 5);
    CHECK(answers("round", text("wall_loss = \"60 dB\"\nmesh = true")) == 20);
    const std::string routes = text_of(bench.out("round") / "routes.csv");
    CHECK(routes.find("0.000000,client,server,between,2\n") != std::string::npos);
    CHECK(bench.report("round")["nodes"]["network"]["mesh"]["passed_on"]["between"] == 40);
    REQUIRE(
        bench.run("apart", {bench.file("round.toml", text("wall_loss = \"60 dB\"\nmesh = true"))}).status ==
        0);
    check_same_run(bench, "round", "apart");
}

TEST_CASE("asyncio: many connections, datagrams, time-outs beside each other", "[network]") {
    const Workbench bench;
    check_everywhere(
        bench,
        bench.file("aio.toml",
                   hosts({{"server", python("aio_server.py")}, {"client", python("aio_client.py")}}, "2 s")));
    const std::string client = log_of(bench, "o0", "client");
    INFO(client);
    CHECK(count(client, "you said") == 15);
    CHECK(count(client, "echo") == 1);
    CHECK(client.find("timeout 0.5\n") != std::string::npos);
    CHECK(client.find("Connect call failed") != std::string::npos);
    CHECK(count(log_of(bench, "o0", "server"), "tick") == 7);
}

TEST_CASE("a thousand connections at once", "[network]") {
    const Workbench bench;
    const std::string text = hosts(
        {{"server", python("crowd_server.py", {"1000"})}, {"client", python("crowd_client.py", {"1000"})}},
        "20 s");
    const auto file = bench.file("crowd.toml", text);
    const Ended ended = bench.run("o", {file, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const std::string client = log_of(bench, "o", "client");
    INFO(client);
    CHECK(client.starts_with("opened 1000 right 1000\n"));
    CHECK(log_of(bench, "o", "server") == "all 1000\nnone\n");
    REQUIRE(bench.run("apart", {file}).status == 0);
    check_same_run(bench, "o", "apart");
}

TEST_CASE("Boost.Asio: edge-triggered, a resolver's thread, timers", "[network]") {
    const Workbench bench;
    const std::string program = PUCKLOOP_ASIO_TALK;
    check_everywhere(
        bench,
        bench.file("asio.toml", hosts({{"server", list_of({program, "server", "7000", "3"})},
                                       {"one", list_of({program, "client", "server", "7000", "one"})},
                                       {"two", list_of({program, "client", "10.0.0.254", "7000", "two"})},
                                       {"three", list_of({program, "client", "server", "7000", "three"})},
                                       {"lost", list_of({program, "client", "nobody", "7000", "lost"})}},
                                      "2 s")));
    CHECK(log_of(bench, "o0", "two") == "got two 0\ngot two 1\ngot two 2\n");
    CHECK(log_of(bench, "o0", "lost") == "Host not found (authoritative)\n");
    const std::string server = log_of(bench, "o0", "server");
    INFO(server);
    CHECK(count(server, "line ") == 9);
    CHECK(count(server, "gone: End of file") == 3);
    CHECK(count(server, "ticks ") == 1);
    // Nobody spins on a socket that has nothing new.
    CHECK(bench.report("o0")["nodes"]["server.linux"]["requests"] < 3000);
}

TEST_CASE("nc on both ends", "[network]") {
    if (!fs::exists("/bin/nc") && !fs::exists("/usr/bin/nc")) {
        WARN("there is no nc: skipped");
        return;
    }
    const Workbench bench;
    std::string text = hosts({{"server", R"(["nc", "-l", "-p", "7000"])"},
                              {"client", R"(["sh", "-c", "echo by nc | nc -N server 7000; echo $?"])"}},
                             "2 s");
    text += "start = \"0.5 s\"\n";
    check_everywhere(bench, bench.file("nc.toml", text));
    CHECK(log_of(bench, "o0", "server") == "by nc\n");
    CHECK(log_of(bench, "o0", "client") == "0\n");
}

TEST_CASE("curl, requests, iperf3, nc and ping between four robots, with range and loss", "[network]") {
    for (const char* tool : {"/usr/bin/curl", "/usr/bin/iperf3", "/usr/bin/nc", "/usr/bin/ping"})
        if (!fs::exists(tool)) {
            WARN("there is no " << tool << ": skipped");
            return;
        }
    const Workbench bench;
    const std::vector<std::string> programs{
        "iperf3 -s -1 > /dev/null & nc -l -p 7000 & python3 -B -m http.server 8000 2> /dev/null",
        "sleep 2; curl -s -o /dev/null -w '%{http_code} %{size_download}\\n' http://robot0:8000/more.toml; "
        "echo by nc | nc -N robot0 7000",
        "sleep 2; python3 -B -c 'import requests; "
        "print(requests.get(\\\"http://robot0:8000/more.toml\\\").status_code)'",
        "sleep 2; ping -c 3 -i 0.2 robot1 | grep received; iperf3 -c robot0 -u -b 200K -t 1 -J | grep -c "
        "jitter"};
    std::string text =
        "[run]\nduration = \"6 s\"\n[arena]\nsize = [\"3 m\", \"2 m\"]\n[network]\nmode = \"wifi\"\n"
        "access_point = [\"6 m\", \"1 m\"]\n";
    for (std::size_t i = 0; i < programs.size(); ++i)
        text += fmt::format("[[robot]]\nposition = [\"{} cm\", \"0 cm\"]\n[robot.pic]\nfirmware = \"own\"\n"
                            "[robot.linux]\nprogram = [\"sh\", \"-c\", \"cd {}; {}; sleep 60\"]\n",
                            40 * i, bench.folder().string(), programs[i]);
    text += "[[fault]]\nnode = \"network\"\nkind = \"loss\"\nprobability = 0.05\n";
    bench.file("more.toml", text);
    check_everywhere(bench, bench.folder() / "more.toml");
    CHECK(log_of(bench, "o0", "robot1").find(fmt::format("200 {}\n", text.size())) != std::string::npos);
    CHECK(log_of(bench, "o0", "robot2") == "200\n");
    const std::string log = log_of(bench, "o0", "robot3");
    INFO(log);
    CHECK(log.find("received") != std::string::npos);
    CHECK(log.find(", 100% packet loss") == std::string::npos);
    CHECK(count(log_of(bench, "o0", "robot0"), "by nc\n") == 1);
}

TEST_CASE("a lossy network shows as retransmission and time, not as wrong data", "[network]") {
    const Workbench bench;
    const auto file = bench.file(
        "bulk.toml", hosts({{"server", python("bulk_server.py")}, {"client", python("bulk_client.py")}},
                           "30 s", "mode = \"fixed\"\nlatency = \"2 ms\"\nrate = \"8 Mbit/s\""));
    const auto seconds = [&](const std::string& run, const Words& more) {
        Words words{file.string(), "--in-process"};
        words.insert(words.end(), more.begin(), more.end());
        const Ended ended = bench.run(run, words);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        const std::string log = log_of(bench, run, "client");
        INFO(log);
        REQUIRE(log.starts_with("same True "));
        return std::stod(log.substr(10));
    };
    const double sound = seconds("sound", {});
    // 500,000 octets in 343 segments of 1500 at 8 Mbit/s, and an acknowledgement of 40 for two.
    CHECK(sound == Approx(343 * 1500 * 8 / 8e6 + 171 * 40 * 8 / 8e6).epsilon(0.1));
    const auto tcp = [&](const std::string& run) {
        return bench.report(run)["nodes"]["client.linux"]["network"]["tcp"];
    };
    CHECK(tcp("sound")["retransmitted"] == 0);
    const Words loss{"--fault", "loss node=network probability=0.05 name=lossy"};
    const double lossy = seconds("lossy", loss);
    CHECK(lossy > 1.2 * sound);
    CHECK(tcp("lossy")["retransmitted"] > 5);
    CHECK(seconds("again", loss) == lossy);
    check_same_run(bench, "lossy", "again");
    const Ended decoded =
        bench.puckloop({"trace", "decode", bench.out("lossy").string(), "--protocol", "ip"});
    CHECK(decoded.status == 0);
    CHECK(decoded.out.find("ip: TCP 10.0.0.253:") != std::string::npos);
    const auto fault = bench.report("lossy")["faults"][0];
    CHECK(fault["fired"] > 5);
    CHECK(fault["firings"][0]["what"].get<std::string>().find("TCP 10.0.0.") != std::string::npos);
    const double cut =
        seconds("cut", {"--fault", "partition node=network begin=300ms end=1300ms group=client"});
    CHECK(cut > sound + 0.9);
    CHECK(seconds("slow", {"--fault", "rate node=network rate=1e6"}) > 7 * sound);
    for (const char* kind :
         {"duplicate node=network probability=0.1", "corrupt node=network probability=0.02",
          "reorder node=network probability=0.05", "delay node=network delay=5ms jitter=5ms"})
        CHECK(seconds("other", {"--fault", kind}) >= 0.99 * sound);
    // As pcapng, and what tshark makes of it.
    const Ended exported = bench.puckloop({"trace", "export", bench.out("lossy").string(), "--format",
                                           "pcapng", "--output", (bench.folder() / "lossy.pcapng").string()});
    INFO(exported.err);
    REQUIRE(exported.status == 0);
    if (!fs::exists("/usr/bin/tshark")) return;
    Process tshark({"tshark", "-r", (bench.folder() / "lossy.pcapng").string(), "-Y",
                    "_ws.malformed or ip.checksum.status == 0 or tcp.checksum.status == 0", "-o",
                    "tcp.desegment_tcp_streams:FALSE", "-o", "ip.check_checksum:TRUE", "-o",
                    "tcp.check_checksum:TRUE"},
                   bench.folder());
    const Ended read = tshark.wait();
    CHECK(read.status == 0);
    CHECK(read.out.empty());
}

TEST_CASE("a connection is reset at the octet that the fault names", "[network]") {
    const Workbench bench;
    const auto file = bench.file(
        "reset.toml", hosts({{"server", python("counting_server.py")}, {"client", python("bulk_client.py")}},
                            "3 s", "mode = \"fixed\"\nlatency = \"2 ms\"\nrate = \"8 Mbit/s\""));
    const std::string fault = "connection_reset node=network from=client byte=123456";
    // The client's own end by the exception is the run's failure.
    CHECK(bench.run("o", {file, "--in-process", "--fault", fault}).status == 1);
    CHECK(bench.run("apart", {file, "--fault", fault}).status == 1);
    check_same_run(bench, "o", "apart");
    CHECK(log_of(bench, "o", "server") == "123456 ConnectionResetError\n");
    CHECK(log_of(bench, "o", "client").find("ConnectionResetError") != std::string::npos);
    CHECK(bench.report("o")["faults"][0]["fired"] == 1);
    // An address that the server shares: the connection is refused by the other one.
    CHECK(
        bench.run("clash", {file, "--in-process", "--fault", "address_clash node=network to=server share=1"})
            .status == 1);
    CHECK(log_of(bench, "clash", "client").find("ConnectionRefusedError") != std::string::npos);
}

TEST_CASE("names are not answered while the fault lasts", "[network]") {
    const Workbench bench;
    const auto file = bench.file(
        "names.toml", hosts({{"server", R"(["true"])"}, {"client", python("asks_names.py")}}, "30 s"));
    const Words words{file, "--in-process", "--fault", "dns_silence node=client.linux for=17s timeout=4s"};
    const Ended ended = bench.run("o", words);
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    // Two questions, 4 s each; the third time the second one is at 20 s.
    CHECK(log_of(bench, "o", "client") ==
          "0.0 own 10.0.0.253 after 0.0\n0.0 number ('10.0.0.254', 7) after 0.0\nhosts 0\n"
          "0.0 server gaierror -3 after 8.0\n8.0 server gaierror -3 after 8.0\n"
          "16.0 server ('10.0.0.254', 7) after 4.0\n20.0 server 10.0.0.254 after 0.0\n"
          "20.0 nobody gaierror -2 after 0.0\n");
    CHECK(bench.report("o")["faults"][0]["fired"] == 3);
    const Ended apart = bench.run("apart", {file, "--fault", words[3]});
    REQUIRE(apart.status == 0);
    check_same_run(bench, "o", "apart");
}

TEST_CASE("programs with a resolver of their own ask the board's, and a silent one is evidence",
          "[network][dns]") {
    const Workbench bench;
    const auto text = [](const Words& words) {
        return hosts({{"server", R"(["true"])"}, {"client", python("dns_questions.py", words)}}, "6 s");
    };
    check_everywhere(bench, bench.file("ask.toml", text({})));
    CHECK(log_of(bench, "o0", "client") ==
          "servers ['127.0.0.53']\nserver 1 10.0.0.254\nSERVER 1 10.0.0.254\nnobody 1 status 3\n"
          "server 28 status 0\n254.0.0.10.in-addr.arpa 12 server\n");
    CHECK(bench.report("o0")["nodes"]["client.linux"]["warnings"] ==
          nlohmann::json::array({"no computer of the network has the name 'nobody'"}));
    const Ended ended = bench.run("silent", {bench.file("silent.toml", text({"wait"})), "--in-process",
                                             "--fault", "dns_silence node=client.linux begin=1500ms for=1s"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const std::string log = log_of(bench, "silent", "client");
    INFO(log);
    CHECK(count(log, "10.0.0.254\n") == 3);
    CHECK(count(log, "2.0 no answer\n") == 1);
    const auto fault = bench.report("silent")["faults"][0];
    CHECK(fault["fired"] == 1);
    CHECK(fault["firings"][0]["what"] == "the question for server is not answered");
    if (!fs::exists("/usr/bin/dig")) return;
    const std::string dig =
        R"(["sh", "-c", "dig +short server; dig +short -x 10.0.0.254; dig nobody | grep -c NXDOMAIN"])";
    REQUIRE(
        bench
            .run("dig", {bench.file("dig.toml", hosts({{"server", R"(["true"])"}, {"client", dig}}, "9 s")),
                         "--in-process"})
            .status == 0);
    CHECK(log_of(bench, "dig", "client") == "10.0.0.254\nserver.\n1\n");
}

TEST_CASE("the C library's own questions to a name server come to the board's", "[network][dns]") {
    const Workbench bench;
    const auto text = hosts({{"server", R"(["true"])"}, {"client", list_of({PUCKLOOP_QUESTIONS})}}, "30 s");
    const std::string rest =
        "search: 10.0.0.254\ndomain: 10.0.0.254\npointer: server\nnobody: Unknown host\n"
        "no such record: No address associated with name\nno name: Unknown server error\n"
        "servers 1 127.0.0.53\nstate: 10.0.0.254\nits error 1\nsend: 10.0.0.254\n"
        "urgent Operation not supported, Invalid argument\n";
    check_everywhere(bench, bench.file("ask.toml", text));
    CHECK(log_of(bench, "o0", "client") == "query: 10.0.0.254\nafter 0 s\n" + rest);
    CHECK(bench.report("o0")["nodes"]["client.linux"]["warnings"] ==
          nlohmann::json::array({"urgent data (MSG_OOB) is not carried by the network",
                                 "no computer of the network has the name 'nobody'"}));
    // The second question is answered, or none.
    const auto silent = [&](const std::string& time) {
        const Ended ended = bench.run("silent", {(bench.folder() / "ask.toml").string(), "--in-process",
                                                 "--fault", "dns_silence node=client.linux for=" + time});
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        return log_of(bench, "silent", "client");
    };
    CHECK(silent("3s") == "query: 10.0.0.254\nafter 5 s\n" + rest);
    CHECK(silent("8s") == "query: Host name lookup failure\nafter 10 s\n" + rest);
}

TEST_CASE("ip shows the board's interfaces, addresses and ways, and may not change them",
          "[network][netlink]") {
    if (!fs::exists("/usr/sbin/ip") && !fs::exists("/sbin/ip")) {
        WARN("there is no ip: skipped");
        return;
    }
    const Workbench bench;
    const auto file = bench.file(
        "ip.toml",
        hosts({{"server", R"(["true"])"},
               {"tools",
                "[\"sh\", \"-c\", \"PATH=$PATH:/usr/sbin:/sbin; ip -o addr show up | cut -d' ' -f 1-7; ip -o "
                "link show wlan0 | grep -o 'mtu 1500\\\\|link/ether [^ ]*\\\\|state UP'; ip route; ip route "
                "get "
                "10.0.0.254; ip route get 9.9.9.9 2>&1; ip link set lo down 2>&1; ip neigh; echo end\"]"}},
              "3 s"));
    const Ended ended = bench.run("o", {file, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    CHECK(log_of(bench, "o", "tools") ==
          "1: lo    inet 127.0.0.1/8\n2: wlan0    inet 10.0.0.253/24\n"
          "mtu 1500\nstate UP\nlink/ether 02:00:0a:00:00:fd\n"
          "10.0.0.0/24 dev wlan0 proto kernel scope link src 10.0.0.253 \n"
          "10.0.0.254 dev wlan0 proto kernel scope link src 10.0.0.253 \n"
          "RTNETLINK answers: Network is unreachable\nRTNETLINK answers: Operation not permitted\nend\n");
    REQUIRE(bench.run("apart", {file}).status == 0);
    check_same_run(bench, "o", "apart");
}

TEST_CASE("a server that is killed ends its connections, and one that is paused does not", "[network]") {
    const Workbench bench;
    const auto file = bench.file(
        "kill.toml", hosts({{"server", python("bulk_server.py")}, {"client", python("bulk_client.py")}},
                           "3 s", "mode = \"fixed\"\nlatency = \"2 ms\"\nrate = \"8 Mbit/s\""));
    const auto run = [&](const std::string& name, const std::string& fault, bool in_process) {
        Words words{file.string(), "--fault", fault};
        if (in_process) words.emplace_back("--in-process");
        return bench.run(name, words);
    };
    const std::string kill = "kill node=server.linux at=400ms run=goes_on";
    // The client's own end by the exception is the run's failure.
    CHECK(run("killed", kill, true).status == 1);
    CHECK(run("apart", kill, false).status == 1);
    check_same_run(bench, "killed", "apart");
    const std::string log = log_of(bench, "killed", "client");
    INFO(log);
    CHECK((log.find("ConnectionResetError") != std::string::npos ||
           log.find("BrokenPipeError") != std::string::npos));
    REQUIRE(run("paused", "pause node=server.linux at=400ms time=500ms", true).status == 0);
    const std::string paused = log_of(bench, "paused", "client");
    REQUIRE(paused.starts_with("same True "));
    CHECK(std::stod(paused.substr(10)) > 0.54 + 0.3);
}

TEST_CASE("the network manager passes messages by number, as far as range and hops allow", "[network]") {
    const Workbench bench;
    const auto member = [&](const std::string& place, const std::string& line) {
        return python("member.py", {place, line});
    };
    const auto text = [&](const Words& options) {
        Words manager{PUCKLOOP_NETMANAGER, "--robot",     "10.0.0.11=1",
                      "--robot",           "10.0.0.12=2", "--robot",
                      "10.0.0.13=3",       "--log",       (bench.folder() / "manager.csv").string()};
        manager.insert(manager.end(), options.begin(), options.end());
        std::string all = hosts({{"manager", list_of(manager)}}, "2 s");
        const std::vector<std::pair<std::string, std::string>> members{
            {"0,0", "-1 from one"}, {"1,0", "3 to three"}, {"2,0", "1 to one"}};
        for (std::size_t i = 0; i < members.size(); ++i)
            all += fmt::format("[[host]]\nname = \"m{}\"\naddress = \"10.0.0.{}\"\nprogram = {}\n", i + 1,
                               i + 11, member(members[i].first, members[i].second));
        return all;
    };
    check_everywhere(bench, bench.file("manager.toml", text({})));
    CHECK(log_of(bench, "o0", "m1") == "3 to one\n");
    CHECK(log_of(bench, "o0", "m2") == "1 from one\n");
    CHECK(log_of(bench, "o0", "m3") == "1 from one\n2 to three\n");
    CHECK(count(text_of(bench.folder() / "manager.csv"), ",passed,") ==
          4 + 3);  // and who is there already hears "here"
    const auto run = [&](const Words& options) {
        const Ended ended = bench.run("limited", {bench.file("limited.toml", text(options)), "--in-process"});
        INFO(ended.err);
        REQUIRE(ended.status == 0);
    };
    run({"--range", "1.5"});
    CHECK(log_of(bench, "limited", "m1").empty());
    CHECK(log_of(bench, "limited", "m3") == "2 to three\n");
    CHECK(count(text_of(bench.folder() / "manager.csv"), ",too_far,3,1,") == 1);
    run({"--range", "1.5", "--hops", "2", "--hop-delay", "0.05"});
    CHECK(log_of(bench, "limited", "m1") == "3 to one\n");
    CHECK(log_of(bench, "limited", "m3") == "2 to three\n1 from one\n");  // one hop, then two
}

TEST_CASE("the manager's settings change while the run goes on, the same in every placement", "[network]") {
    const Workbench bench;
    Words manager{PUCKLOOP_NETMANAGER, "--status", "0.2"};
    std::string text = hosts({{"manager", list_of(manager)}}, "6 s");
    for (int i = 1; i <= 2; ++i)
        text += fmt::format("[[host]]\nname = \"m{}\"\naddress = \"10.0.0.{}\"\nprogram = {}\n", i, i,
                            python("sender.py", {fmt::format("{}", i), fmt::format("{}", 3 - i)}));
    const std::vector<std::pair<double, std::string>> changes{
        {1.05, "loss 1 1 2"}, {2.05, "loss 0 1 2"}, {2.05, "range 0.5"}, {3.05, "range none"},
        {3.05, "delay 0.5"},  {4.05, "delay 0"},    {4.55, "warp 9"}};
    for (const auto& [time, words] : changes)
        text += fmt::format("[[event]]\nat = \"{} s\"\nsend = \"manager\"\ntext = \"{}\"\n", time, words);
    check_everywhere(bench, bench.file("live.toml", text));
    // Each sends a number ten times a second from 0.5 s on; what the other one hears of each second.
    const auto heard = [&](const std::string& who) {
        std::istringstream lines(log_of(bench, "o0", who));
        std::vector<int> by_second(7);
        double delay_at_3 = 0;
        for (std::string word; lines >> word;) {  // "2 sent at 1.500 came at 1.501"
            double sent = 0, came = 0;
            std::string skip;
            lines >> skip >> skip >> sent >> skip >> skip >> came;
            ++by_second.at(static_cast<std::size_t>(sent - 0.05));
            if (sent > 3.2 && sent < 3.8) delay_at_3 = std::max(delay_at_3, came - sent);
        }
        CHECK(delay_at_3 == Approx(0.5).epsilon(0.02));
        return by_second;
    };
    CHECK(heard("m2") == std::vector<int>{5, 0, 0, 10, 9, 0, 0});  // lost, too far
    CHECK(heard("m1") == std::vector<int>{5, 10, 0, 10, 9, 0, 0});
    const std::string log = log_of(bench, "o0", "manager");
    INFO(log);
    CHECK(count(log, "set loss 1 1 2\n") == 1);
    CHECK(count(log, "not set: 'warp' (expected range M") == 1);
    CHECK(count(log, "status {\"time_s\":") > 10);
    CHECK(log.find("[1,2,1,5,7,") != std::string::npos);
    const auto events = bench.report("o0")["nodes"]["world"]["events"];
    REQUIRE(events.size() == 7);
    CHECK(events[0]["action"] == "send manager text \"loss 1 1 2\"");
}

TEST_CASE("a manager that is killed comes back to robots that connect again", "[network]") {
    const Workbench bench;
    std::string text =
        fmt::format("[run]\nduration = \"14 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n[network]\n[[host]]\n"
                    "name = \"manager\"\nprogram = [\"{}\", \"--log\", \"{}\"]\n",
                    PUCKLOOP_NETMANAGER, (bench.folder() / "killed.csv").string());
    for (int i = 0; i < 2; ++i)
        text +=
            fmt::format("[[robot]]\nposition = [\"{} cm\", \"0 cm\"]\n[robot.pic]\nfirmware = \"network\"\n"
                        "selector = 10\n[robot.linux]\nprogram = [\"{}\", \"--server\", \"manager:7700\"]\n",
                        30 * i - 15, PUCKLOOP_FORWARD);
    const auto file = bench.file("killed.toml", text);
    const Words words{file, "--in-process", "--fault", "restart node=manager.linux at=4s down=1500ms"};
    const Ended ended = bench.run("o", words);
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    for (const char* robot : {"robot0", "robot1"}) {
        const std::string log = log_of(bench, "o", robot);
        INFO(log);
        CHECK(count(log, "connected with manager:7700\n") == 2);
        CHECK(log.find("manager:7700: ") != std::string::npos);
    }
    // The log is the second manager's: both are back within a second of it, and their messages pass.
    const std::string events = text_of(bench.folder() / "killed.csv");
    INFO(events);
    CHECK(count(events, ",connected,") == 2);
    CHECK(count(events, ",passed,") >= 2);
    REQUIRE(bench.run("apart", {file, "--fault", words[3]}).status == 0);
    check_same_run(bench, "o", "apart");
}

TEST_CASE("a server drives a robot through puckloop-forward", "[network]") {
    const Workbench bench;
    const std::string text =
        hosts({{"server", python("remote_driver.py")}}, "2 s") +
        fmt::format("[[robot]]\nposition = [\"0 cm\", \"0 cm\"]\n[robot.pic]\nfirmware = \"own\"\n"
                    "[robot.linux]\nstart = \"100 ms\"\nprogram = {}\n",
                    list_of({PUCKLOOP_FORWARD, "--server", "server:7700"}));
    check_everywhere(bench, bench.file("forward.toml", text));
    CHECK(log_of(bench, "o0", "server") == "robot 10.0.0.1\nproximity 8\ndriven\n");
    const std::string robot = log_of(bench, "o0", "robot0");
    INFO(robot);
    CHECK(robot.starts_with("connected with server:7700\n"));
    // Neither end spins: 500 bytes each way in pieces of the UART, and looks at time-outs.
    CHECK(bench.report("o0")["nodes"]["robot0.linux"]["requests"] < 4000);
    CHECK(journey(bench.csv("o0", "trajectory.csv")).length > 0.01);
}

TEST_CASE("manager and forwarder refuse wrong use in one line, with status 2", "[network]") {
    const Workbench bench;
    const auto check = [&](const Words& words, const std::string& what) {
        Process process(words, bench.folder());
        const Ended ended = process.wait(10.0);
        INFO(ended.err);
        CHECK(ended.status == 2);
        CHECK(ended.error_lines() == 1);
        CHECK(ended.err.find(what) != std::string::npos);
    };
    check({PUCKLOOP_NETMANAGER, "--port", "0"}, "--port: '0'");
    check({PUCKLOOP_NETMANAGER, "--range", "far"}, "--range: 'far'");
    check({PUCKLOOP_NETMANAGER, "--robot", "10.0.0=1"}, "is not ADDRESS=NUMBER");
    check({PUCKLOOP_NETMANAGER, "--port", "0x1"}, "--port");
    check({PUCKLOOP_NETMANAGER, "--loss", "2"}, "--loss: '2'");
    check({PUCKLOOP_NETMANAGER, "--control", "70000"}, "--control: '70000'");
    check({PUCKLOOP_NETMANAGER, "--seed", "-1"}, "--seed: '-1'");
    check({PUCKLOOP_NETMANAGER, "--status", "x"}, "--status: 'x'");
    check({PUCKLOOP_NETMANAGER, "more"}, "'more' is not an option");
    check({PUCKLOOP_NETMANAGER, "--log", "/nowhere/log.csv"}, "/nowhere/log.csv");
    check({PUCKLOOP_FORWARD}, "--server HOST:PORT is missing");
    check({PUCKLOOP_FORWARD, "--server", "server"}, "is not HOST:PORT");
    check({PUCKLOOP_FORWARD, "--server", "a:1", "--retry", "0"}, "--retry");
    check({PUCKLOOP_FORWARD, "--server", "a:1", "--tty", "/dev/null"}, "/dev/null");
}

TEST_CASE("a scenario whose network cannot be is one line with its place, and status 2", "[network]") {
    const Workbench bench;
    const auto check = [&](const std::string& network, const std::string& host, const Words& words) {
        const std::string text = "[run]\nduration = \"1 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n" + network +
                                 "[[host]]\nprogram = [\"true\"]\n" + host;
        const auto file = bench.file("bad.toml", text);
        check_one_line(bench.run("o", {file}), 2, words);
    };
    const std::string fine = "[network]\n";
    check("", "", {"bad.toml", "line 5", "a host without a network"});
    check("[network]\naddress = \"10.0.0.0\"\n", "", {"line 6", "is no network"});
    check("[network]\naddress = \"10.0.0.0/33\"\n", "", {"line 6", "33 bits"});
    check("[network]\naddress = \"10.0.0.5/24\"\n", "", {"line 6", "10.0.0.0/24"});
    check("[network]\nlatency = \"0 s\"\n", "", {"line 6", "latency is out of range"});
    check("[network]\nmode = \"warp\"\n", "", {"line 6", "perfect", "fixed"});
    check("[network]\nrate = \"1 Mbit/s\"\n", "", {"line 6", "a perfect network has no rate"});
    check("[network]\nmode = \"fixed\"\nrate = \"fast\"\n", "", {"line 7", "is no rate"});
    check("[network]\nmode = \"fixed\"\nrate = \"1 bit/s\"\n", "", {"line 7", "rate is out of range"});
    check(fine, "address = \"10.0.1.1\"\n", {"line 6", "host0", "10.0.1.1 is none of a computer"});
    check(fine, "address = \"10.0.0.255\"\n", {"10.0.0.255 is none of a computer"});
    check(fine, "address = \"ten\"\n", {"line 8", "is no address"});
    check(fine,
          "address = \"10.0.0.7\"\n[[host]]\nname = \"b\"\nprogram = [\"true\"]\naddress = \"10.0.0.7\"\n",
          {"line 9", "host0 has the address 10.0.0.7 already"});
    check(fine, "[[host]]\nname = \"host0\"\nprogram = [\"true\"]\n",
          {"something else has the name 'host0'"});
    check("[network]\naddress = \"10.0.0.0/30\"\n",
          "[[host]]\nprogram = [\"true\"]\n[[host]]\nprogram = [\"true\"]\n", {"no address left"});
    check("[network]\nmode = \"wifi\"\naccess_point = [\"0 m\", \"0 m\"]\n[network.wifi]\nmesh = true\n", "",
          {"line 7", "a mesh has no access point"});
    check("[network]\nmode = \"wifi\"\n[network.wifi]\nwall_loss = \"-1 dB\"\n", "",
          {"line 8", "wall_loss is out of range"});
    check("[network]\nmode = \"wifi\"\n[network.wifi]\nmesh_hops = 0\n", "",
          {"line 8", "mesh_hops is out of range"});
    check(fine, "[[event]]\nat = \"1 s\"\nsend = \"nobody\"\ntext = \"x\"\n",
          {"line 8", "there is no 'nobody' on the network (expected host0)"});
    check(fine, "[[event]]\nat = \"1 s\"\nsend = \"host0\"\n", {"line 8", "'text' is missing"});
    check(fine, "[[event]]\nat = \"1 s\"\nsend = \"host0\"\ntext = \"x\"\nport = 0\n",
          {"line 12", "port is out of range"});
    check(fine, "[[fault]]\nnode = \"network\"\nkind = \"loss\"\nfrom = \"nobody\"\n",
          {"'nobody' is at no end of network"});
    check(fine, "[[fault]]\nnode = \"network\"\nkind = \"partition\"\ngroup = \"nobody\"\n",
          {"there is no 'nobody' on the network"});
    check(fine, "[[fault]]\nnode = \"network\"\nkind = \"access_point_away\"\n",
          {"line 10", "no access point that could be away"});
    check(fine, "[[fault]]\nnode = \"network\"\nkind = \"connection_reset\"\nbyte = -1\n",
          {"line 11", "byte is out of range"});
    check(fine, "[[fault]]\nnode = \"network\"\nkind = \"address_clash\"\ncache = \"0 s\"\n",
          {"line 11", "cache is out of range"});
    check(fine, "[[fault]]\nnode = \"network\"\nkind = \"delay\"\ndelay = \"1 ms\"\njitter = \"2 ms\"\n",
          {"the jitter is larger than the delay"});
}
