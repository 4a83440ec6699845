// What has an address, and that nothing else does; who may ask.

#include "base/json.h"
#include "tests/view/results.h"
#include "view/answers.h"
#include "view/server/access.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <random>
#include <set>

using namespace puckloop::tests;
using namespace puckloop::view;

TEST_CASE("parts of the page and derived data have addresses") {
    const Recording recording(write_results("view_answers"));
    EventReader events(recording);
    events.wait();
    const Answers answers(recording, events);
    CHECK(answers.get("")->body.find("page.js") != std::string::npos);
    CHECK(answers.get("")->type.starts_with("text/html"));
    CHECK(answers.get("page.js")->body.find("class ArenaView") != std::string::npos);
    CHECK(answers.get("page.js")->body.find("\nimport ") == std::string::npos);
    CHECK(answers.get("page.js")->body.find("\nexport ") == std::string::npos);
    CHECK(answers.get("page.css")->type.starts_with("text/css"));
    CHECK(nlohmann::json::parse(answers.get("head")->body)["robots"] == 1);
    CHECK(answers.get("poses")->body == recording.poses());
    CHECK(answers.get("events?from=0")->body.size() > 16);
    CHECK(answers.get("leds?from=1")->body.size() == 16 + 12);
    CHECK(answers.get("sensors?robot=0")->body == recording.sensors(0));
    const auto number = events.table().find("hello", 1).at(0);
    const auto texts =
        nlohmann::json::parse(answers.get("texts?numbers=" + std::to_string(number) + ",99")->body);
    CHECK(texts[0] == "uart1 prints: hello");
    CHECK(texts[1] == "");
    CHECK(answers.get("find?text=prints%3A+HELLO")->body.size() == 4);
}

TEST_CASE("bytes of a serial line come from a place of the trace on, whole rows only") {
    const auto folder = write_results("view_serial");
    const Recording recording(folder);
    EventReader events(recording);
    events.wait();
    const Answers answers(recording, events);
    const auto get = [&](const std::string& query) {
        return nlohmann::json::parse(answers.get("serial?from=" + query)->body);
    };
    const auto all = get("0,robot0.uart1");
    CHECK(all["from"] == nlohmann::json{"robot0.pic"});
    CHECK(all["v"] == nlohmann::json{'A', 'B', 'C'});
    CHECK(all["k"] == nlohmann::json{0, 0, 0});
    CHECK(all["f"] == nlohmann::json{0, 0, 0});
    CHECK(all["t"][0].get<double>() == Approx(0.5 + 9.0 / 115'200));
    CHECK(all["more"] == false);
    const auto none = get(all["next"].dump() + ",robot0.uart1");
    CHECK(none["v"].empty());
    CHECK(none["next"] == all["next"]);
    CHECK(get("0,robot0.uart")["v"].empty());
    CHECK(get("99999999,robot0.uart1")["v"].empty());
    // A row that is being written, then its end; lost, typed and broken ones.
    const auto trace = folder / "trace.csv";
    std::ofstream(trace, std::ios::app)
        << "2.1,robot0.uart1,robot0.pic,uart,44,8N1,2.0,8.68e-06,0,drop\n"
        << "2.2,robot0.uart1,robot0.uart1,uart,45,8N1,2.0,8.68e-06,0,insert\n"
        << "2.3,robot0.uart1,robot0.pic,break,00,8N1,2.0,8.68e-06,0,\nnonsense\n,robot0.uart1,\n"
        << "2.4,robot0.uart1,robot0.pic,ua";
    const auto more = get(all["next"].dump() + ",robot0.uart1");
    CHECK(more["k"] == nlohmann::json{1, 2, 3});
    CHECK(more["from"] == nlohmann::json{"robot0.pic", "robot0.uart1"});
    CHECK(more["f"] == nlohmann::json{0, 1, 0});
    std::ofstream(trace, std::ios::app) << "rt,46,8N1,2.0,8.68e-06,0,\n";
    CHECK(get(more["next"].dump() + ",robot0.uart1")["v"] == nlohmann::json{'F'});
    for (const char* wrong : {"0", "0,", ",robot0.uart1", "x,robot0.uart1", "-1,robot0.uart1", "0,%zz"})
        CHECK_FALSE(answers.get(std::string("serial?from=") + wrong));
    CHECK_FALSE(answers.get("serial?from=0," + std::string(201, 'x')));
}

TEST_CASE("pictures of cameras are had by number, and nothing else in their folders") {
    const auto folder = write_results("view_cameras");
    const Recording recording(folder);
    EventReader events(recording);
    events.wait();
    const Answers answers(recording, events);
    CHECK(answers.get("cameras")->body == "[]");
    std::filesystem::create_directories(folder / "robot0.omni");
    const std::string picture = "P6\n1 1\n255\nabc";
    std::ofstream(folder / "robot0.omni/00000030.ppm") << picture;
    std::ofstream(folder / "robot0.omni/secret.ppm") << "no";
    std::filesystem::create_symlink("secret.ppm", folder / "robot0.omni/00000060.ppm");
    std::ofstream(folder / "robot0.omni.csv")
        << "t_s,frame,sequence,width,height,format,hash\n0.100000,29,0,1,1,RGB3,0\n0.200000,30,1,1,1,RGB3,0\n"
        << "nonsense\n0.3,-1,2,1,1,RGB3,0\n0.4,1e300,2,1,1,RGB3,0\n";
    const auto list = nlohmann::json::parse(answers.get("cameras")->body);
    REQUIRE(list.size() == 1);
    CHECK(list[0]["robot"] == "robot0");
    CHECK(list[0]["kind"] == "omni");
    CHECK(list[0]["t"] == nlohmann::json{0.2});
    CHECK(list[0]["frame"] == nlohmann::json{30});
    const std::string number = list[0]["camera"].dump();
    CHECK(answers.get("picture?of=" + number + ",30")->body == picture);
    for (const std::string& wrong : {number, number + ",", number + ",29", number + ",60", number + ",-1",
                                     number + ",30,1", std::string("0,30"), std::string("99,30"),
                                     std::string("x,30"), number + ",secret", number + ",../robot0.omni/30"})
        CHECK_FALSE(answers.get("picture?of=" + wrong));
}

TEST_CASE("everything else has none: names of files, paths, broken numbers") {
    const Recording recording(write_results("view_paths"));
    EventReader events(recording);
    events.wait();
    const Answers answers(recording, events);
    for (const char* target : {"trace.csv",
                               "report.json",
                               "/",
                               "//",
                               "../report.json",
                               "..%2freport.json",
                               "/etc/passwd",
                               "page.js/",
                               "page.js?",
                               "page.js?x=1",
                               "head?",
                               "?",
                               "events",
                               "events?",
                               "events?from=",
                               "events?from=-1",
                               "events?from=1e3",
                               "events?from=99999999999999999999",
                               "events?from=0&from=1",
                               "events?first=0",
                               "sensors?robot=1",
                               "sensors?robot=0x0",
                               "sensors?from=0",
                               "texts?numbers=",
                               "texts?numbers=1,",
                               "texts?numbers=,1",
                               "texts?numbers=a",
                               "find?text=",
                               "find?text=%",
                               "find?text=%4",
                               "find?text=%zz",
                               "find",
                               "HEAD",
                               "head\n",
                               "head#x",
                               "%68ead"}) {
        INFO(target);
        CHECK_FALSE(answers.get(target));
    }
    CHECK_FALSE(answers.get(std::string("head\0", 5)));
    CHECK_FALSE(answers.get("find?text=" + std::string(Answers::kLongestSearch + 1, 'x')));
    CHECK(answers.get("find?text=" + std::string(Answers::kLongestSearch, 'x')));
    std::string many = "texts?numbers=0";
    for (std::size_t i = 1; i < Answers::kMostTexts; ++i)
        many += ",0";
    CHECK(answers.get(many));
    CHECK_FALSE(answers.get(many + ",0"));
}

TEST_CASE("random targets are answered or refused, never more") {
    const Recording recording(write_results("view_fuzz_targets"));
    EventReader events(recording);
    events.wait();
    const Answers answers(recording, events);
    std::mt19937 random(Catch::rngSeed());
    const std::vector<std::string> pieces{
        "events", "texts", "find", "sensors", "leds",    "?", "=",   "&",  "from", "numbers", "text",
        "robot",  ",",     "1",    "0",       "9999999", "%", "%41", "..", "/",    "-",       "\xff"};
    int answered = 0;
    for (int i = 0; i < 20'000; ++i) {
        std::string target;
        for (auto k = random() % 7; k > 0; --k)
            target += pieces[random() % pieces.size()];
        if (const auto content = answers.get(target)) {
            ++answered;
            CHECK(content->body.size() < 1'000'000);
        }
    }
    CHECK(answered > 50);
}

TEST_CASE("escapes are read, broken ones refused") {
    CHECK(unescaped("a%20b+c%2B") == "a b c+");
    CHECK(unescaped("%C3%a9") == "\xc3\xa9");
    CHECK_FALSE(unescaped("%"));
    CHECK_FALSE(unescaped("%4"));
    CHECK_FALSE(unescaped("%g0"));
}

TEST_CASE("tokens are random, and only the whole of one opens") {
    std::set<std::string> tokens;
    for (int i = 0; i < 200; ++i)
        tokens.insert(new_token());
    CHECK(tokens.size() == 200);
    const std::string token = *tokens.begin();
    CHECK(token.size() == 32);
    const Access access(token, 4000);
    CHECK(access.rest_of("/" + token + "/") == "");
    CHECK(access.rest_of("/" + token + "/a/b?c") == "a/b?c");
    for (const std::string& wrong : {std::string(), std::string("/"), "/" + token, token + "/",
                                     "//" + token + "/", "/" + token.substr(1) + "/", "/" + token + "0/",
                                     "/" + *tokens.rbegin() + "/", "/" + std::string(32, '0') + "/"}) {
        INFO(wrong);
        CHECK_FALSE(access.rest_of(wrong));
    }
    for (std::size_t i = 0; i < token.size(); ++i) {
        std::string other = token;
        other[i] = other[i] == '0' ? '1' : '0';
        CHECK_FALSE(access.rest_of("/" + other + "/"));
    }
}

TEST_CASE("only this server's own host and origin may ask") {
    const Access access(new_token(), 4000);
    CHECK_FALSE(access.check("127.0.0.1:4000", ""));
    CHECK_FALSE(access.check("localhost:4000", "http://localhost:4000"));
    for (const char* host :
         {"", "127.0.0.1", "127.0.0.1:4001", "evil.example:4000", "localhost:4000.evil.example",
          "127.0.0.1:4000 ", "[::1]:4000", "0.0.0.0:4000"}) {
        INFO(host);
        CHECK(access.check(host, "") == Refusal::Host);
    }
    for (const char* origin : {"null", "http://evil.example", "https://127.0.0.1:4000",
                               "http://127.0.0.1:4001", "http://127.0.0.1:4000.evil.example", "file://"}) {
        INFO(origin);
        CHECK(access.check("127.0.0.1:4000", origin) == Refusal::Origin);
    }
}
