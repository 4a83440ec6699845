// What a page of a run that goes on is sent: only what is new, and all of it again once the run went back.

#include "tests/view/results.h"
#include "view/recording/feed.h"

#include <catch2/catch.hpp>

#include <cstring>
#include <fstream>
#include <vector>

using namespace puckloop::tests;
using namespace puckloop::view;

namespace {

struct Row {
    std::string name;
    bool robot = false;
    double time = 0.0;
    float x = 0.0F, y = 0.0F, heading = 0.0F;
};

/// What a page makes of messages.
class Page {
  public:
    void take(const std::string& message) {
        for (std::size_t at = 0; at < message.size();) {
            const auto kind = static_cast<Feed::Part>(number<std::uint8_t>(message, at));
            const auto size = number<std::uint32_t>(message, at + 1);
            REQUIRE(at + 5 + size <= message.size());
            part(kind, message.substr(at + 5, size));
            at += 5 + size;
        }
    }
    std::vector<std::string> states;
    std::vector<Row> rows;

  private:
    template <class Number>
    static Number number(const std::string& bytes, std::size_t at) {
        Number value{};
        REQUIRE(at + sizeof value <= bytes.size());
        std::memcpy(&value, bytes.data() + at, sizeof value);
        return value;
    }
    void part(Feed::Part kind, const std::string& bytes) {
        if (kind == Feed::Part::State) {
            states.push_back(bytes);
        } else if (kind == Feed::Part::Name) {
            CHECK(number<std::uint16_t>(bytes, 1) == names_.size());
            names_.push_back({bytes.substr(3), number<std::uint8_t>(bytes, 0) == 1});
        } else {
            REQUIRE(kind == Feed::Part::Rows);
            const std::size_t count = number<std::uint32_t>(bytes, 0);
            CHECK(bytes.size() == 4 + count * 22);
            const auto value = [&](std::size_t column, std::size_t i) {
                return number<float>(bytes, 4 + count * (10 + 4 * column) + 4 * i);
            };
            for (std::size_t i = 0; i < count; ++i) {
                const Row& named = names_.at(number<std::uint16_t>(bytes, 4 + 2 * i));
                rows.push_back({named.name, named.robot, number<double>(bytes, 4 + 2 * count + 8 * i),
                                value(0, i), value(1, i), value(2, i)});
            }
        }
    }
    std::vector<Row> names_;  // a page forgets them when all comes again; here they are counted on
  public:
    void forget() {
        names_.clear();
        rows.clear();
    }
};

void append(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::app) << text;
}

}  // namespace

TEST_CASE("a page is sent what is new, once") {
    const auto folder = write_results("view_feed");
    write_text(folder / "trajectory.csv", "t_s,robot,x_m,y_m,heading_rad\n0,robot0,0.5,-0.25,1.5\n");
    const Recording recording(folder, true);
    std::string state = "{\"epoch\": 0}";
    Feed feed(recording, {[&] { return state; }, [] { return std::uint64_t{0}; }});
    Page page;
    page.take(feed.next());
    CHECK(page.states == std::vector<std::string>{state});
    REQUIRE(page.rows.size() == 1);
    CHECK(page.rows[0].name == "robot0");
    CHECK(page.rows[0].robot);
    CHECK((page.rows[0].x == 0.5F && page.rows[0].y == -0.25F && page.rows[0].heading == 1.5F));
    CHECK(feed.next().empty());
    // Half a row is none yet; a second robot and a thing have numbers of their own.
    append(folder / "trajectory.csv", "0.1,robot0,0.6,0,0\n0.1,robot1,1,1,1\n0.2,robot0,0.7");
    append(folder / "objects.csv", "t_s,object,x_m,y_m,heading_rad\n0.1,robot0,3,3,3\n");
    page.take(feed.next());
    REQUIRE(page.rows.size() == 4);
    CHECK(page.rows[2].name == "robot1");
    CHECK((page.rows[3].name == "robot0" && !page.rows[3].robot && page.rows[3].x == 3.0F));
    append(folder / "trajectory.csv", ",0,0\n");
    state = "{\"epoch\": 0, \"time_s\": 1}";
    page.take(feed.next());
    CHECK(page.states.size() == 2);
    REQUIRE(page.rows.size() == 5);
    CHECK((page.rows[4].time == 0.2 && page.rows[4].x == 0.7F));
}

TEST_CASE("once the run went back, all comes again behind its state") {
    const auto folder = write_results("view_feed_back");
    write_text(folder / "trajectory.csv",
               "t_s,robot,x_m,y_m,heading_rad\n0,robot0,0,0,0\n0.1,robot0,1,0,0\n");
    const Recording recording(folder, true);
    std::uint64_t epoch = 0;
    Feed feed(recording, {[&] { return "epoch " + std::to_string(epoch); }, [&] { return epoch; }});
    Page page;
    page.take(feed.next());
    CHECK(page.rows.size() == 2);
    write_text(folder / "trajectory.csv", "t_s,robot,x_m,y_m,heading_rad\n0,robot0,0,0,0\n");
    epoch = 1;
    page.forget();
    page.take(feed.next());
    CHECK(page.states.back() == "epoch 1");
    CHECK(page.rows.size() == 1);
}

TEST_CASE("a long file comes in several messages, and nothing of it is lost") {
    const auto folder = write_results("view_feed_long");
    std::string text = "t_s,robot,x_m,y_m,heading_rad\n";
    constexpr int kRows = 60'000;
    for (int i = 0; i < kRows; ++i)
        text += std::to_string(i) + ",robot0," + std::to_string(i % 100) + ".25,0.125,0.0625\n";
    write_text(folder / "trajectory.csv", text);
    const Recording recording(folder, true);
    Feed feed(recording, {[] { return std::string("s"); }, [] { return std::uint64_t{0}; }});
    Page page;
    int messages = 0;
    for (std::string message = feed.next(); !message.empty(); message = feed.next(), ++messages)
        page.take(message);
    CHECK(messages > 1);
    REQUIRE(page.rows.size() == kRows);
    for (int i = 0; i < kRows; i += 997)
        CHECK(page.rows[static_cast<std::size_t>(i)].time == i);
}
