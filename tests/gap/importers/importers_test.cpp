// Small fixtures of the same shape as the published sets go through the importers, and what comes out is read
// by the one reader of experiment folders.

#include "base/error.h"
#include "gap/data/experiment.h"
#include "gap/importers/importers.h"
#include "gap/reading/read_experiment.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

void put(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
}

struct Folder {
    fs::path in = tests::scratch_path("gap_set"), out = tests::scratch_path("gap_imported");

    Folder() { remove(); }
    ~Folder() { remove(); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    void remove() const {
        fs::remove_all(in);
        fs::remove_all(out);
    }
    std::vector<WrittenExperiment> import_all() const { return importers::import_set(in, "", out); }
    std::string error() const {
        try {
            import_all();
        } catch (const InputError& e) {
            return e.what();
        }
        return "no error";
    }
};

std::string optiodom_metadata() {
    return "type,diff,,\nngear,50,,\nencRes,20,,\nLi,0.1,,\nDi,0.04,0.042,,\nN,1,,\n";
}

}  // namespace

TEST_CASE("counts and poses of a differential drive become a motion experiment") {
    const Folder f;
    put(f.in / "circular/s1/s1_metadata.csv", optiodom_metadata());
    std::string rows;
    for (int i = 0; i < 40; ++i)
        rows += fmt::format("{},{},{},{},{},{}\n", 0.05 * i, -0.0372 * std::sin(0.25 * i),
                            0.0372 * (std::cos(0.25 * i) - 1), 0.25 * i, i == 0 ? 0 : 25, i == 0 ? 0 : -165);
    put(f.in / "circular/s1/s1_run-01.csv", rows);
    REQUIRE(f.import_all().size() == 1);
    const Experiment e = read_experiment(f.out / "optiodom_circular");
    CHECK(e.kind == Kind::Motion);
    REQUIRE(e.runs.size() == 1);
    CHECK(e.runs[0].rows == 10);
    CHECK(e.runs[0].column("steps_right").back() == 36 * 25);
    CHECK(e.runs[0].column("steps_left").back() == 36 * -165);
    CHECK(e.runs[0].condition("sense") == "counter-clockwise");
    CHECK(e.runs[0].condition("session") == "s1");
    CHECK(e.nominal.at("robot.steps_per_turn") == 1000);
    CHECK(e.nominal.at("robot.wheel_radius_right") == Approx(0.02));
    CHECK(e.nominal.at("robot.wheel_radius_left") == Approx(0.021));
    CHECK(e.nominal.at("robot.axle_length") == Approx(0.1));
}

TEST_CASE("bad files of a differential drive: one line with file and place") {
    const Folder f;
    put(f.in / "circular/s1/s1_metadata.csv", "type,diff\nLi,0.1\n");
    put(f.in / "circular/s1/s1_run-01.csv", "0,0,0,0,0,0\n");
    CHECK_THAT(f.error(), Contains("s1_metadata.csv") && Contains("nominal geometry"));
    put(f.in / "circular/s1/s1_metadata.csv", optiodom_metadata());
    put(f.in / "circular/s1/s1_run-01.csv", "0,0,0,0,0,0\n0.1,x,0,0,0,0\n");
    CHECK_THAT(f.error(), Contains("s1_run-01.csv") && Contains("line 2") && Contains("\"x\""));
    put(f.in / "circular/s1/s1_run-01.csv", "0,0,0,0,0,0\n0.1,0,0,0\n");
    CHECK_THAT(f.error(), Contains("line 2") && Contains("4 cells"));
    put(f.in / "circular/s1/s1_run-01.csv", "0,0,0,0,0,0\n0.1,0,0,0,1,1\n0.1,0,0,0,1,1\n");
    CHECK_THAT(f.error(), Contains("time does not rise"));
    put(f.in / "circular/s1/s1_run-01.csv", "\n\n");
    CHECK_THAT(f.error(), Contains("is empty"));
}

TEST_CASE("proximity, ground and acceleration of a Thymio become three experiments") {
    const Folder f;
    for (const char* light : {"light", "darkness"})
        put(f.in / fmt::format("proximity_sensor02_readings_{}.csv", light),
            "8cm,0,0,1200\r\n2cm,4000,4001,\n0cm,4300,4301,4302\n");
    put(f.in / "ground_sensor_readings.csv",
        " deskeast,, desknorth,, void,\nleft,right,left,right,left,right\n"
        "400,590,402,594,1,2\n402,592,404,596,1,3\n,,,,2.05e-312,1e-310\n");
    put(f.in / "acc_test_run.csv", "0,0,0,0\n0.1,2,1,22\n0.2,3,0,23\n0.3,1,1,22\n");
    CHECK(f.import_all().size() == 3);
    const Experiment proximity = read_experiment(f.out / "thymio_proximity");
    REQUIRE(proximity.runs.size() == 2);
    CHECK(proximity.runs[0].rows == 8);
    CHECK(proximity.runs[0].column("distance_m")[3] == Approx(0.02));
    CHECK(proximity.runs[0].column("ambient")[0] + proximity.runs[1].column("ambient")[0] == 1);
    CHECK(proximity.runs[0].column("sensor")[0] == 2);
    const Experiment ground = read_experiment(f.out / "thymio_ground");
    REQUIRE(ground.runs.size() == 3);
    CHECK(ground.runs[0].condition("surface") == "desk");
    CHECK(ground.runs[0].condition("direction") == "east");
    CHECK(ground.runs[0].column("grey")[0] == Approx(0.402));  // left sensor, both directions
    CHECK(ground.runs[1].column("grey")[0] == Approx(0.402));
    CHECK(ground.runs[2].rows == 4);  // the denormal numbers of empty cells are no readings
    const Experiment acceleration = read_experiment(f.out / "thymio_accelerometer");
    CHECK(acceleration.runs[0].rows == 3);  // without the row of zeros

    put(f.in / "proximity_sensor02_readings_light.csv", "8cm,0\nnear,1\n");
    CHECK_THAT(f.error(), Contains("line 2") && Contains("begins with \"near\""));
}

TEST_CASE("bearings from known places get their truth from geometry") {
    const Folder f;
    put(f.in / "landmark.csv", "0, 0\n6, 0\n6, 6\n0, 6\n");
    put(f.in / "(X1.5,Y1.5).csv", "134.0,-108.0,-45.0,18.0\n135.0,-109.0,-44.5,18.5\n");
    put(f.in / "(X3.0,Y3.0).csv", "135.0,-135.0,-45.0,45.5\n135.0,-134.0,-44.5,45.0\n");
    f.import_all();
    const Experiment e = read_experiment(f.out / "roh_ir_bearing");
    REQUIRE(e.runs.size() == 2);
    const auto& truth = e.runs[0].column("true_bearing_rad");
    const auto& bearing = e.runs[0].column("bearing_rad");
    REQUIRE(truth.size() == 8);
    for (std::size_t i = 0; i < truth.size(); ++i)
        CHECK(std::fabs(truth[i] - bearing[i]) < 1.5 * std::numbers::pi / 180);
    CHECK(e.runs[0].column("distance_m")[0] == Approx(std::hypot(1.5, 1.5)));
    put(f.in / "(X3.0;Q3.0).csv", "1,2,3,4\n");
    CHECK_THAT(f.error(), Contains("position in its name"));
}

TEST_CASE("odometry poses become the wheel counts that move so") {
    const Folder f;
    std::string truth, pose, turn;
    for (int i = 0; i <= 30; ++i) {  // a circle of 0.5 m radius, started at heading 1
        const double a = 0.05 * i, heading = 1 + a;
        truth += fmt::format("  {:e} {:e} {:e}\n", 0.5 * std::sin(a), 0.5 * (1 - std::cos(a)), a);
        pose += fmt::format("  {:e} {:e}\n", 0.5 * (std::sin(heading) - std::sin(1.0)),
                            0.5 * (std::cos(1.0) - std::cos(heading)));
        turn += fmt::format("  {:e} {:e}\n", std::sin(heading / 2), std::cos(heading / 2));
    }
    put(f.in / "run_1/gt.txt", truth);
    put(f.in / "run_1/odom_pose.txt", pose);
    put(f.in / "run_1/odom_quaternion.txt", turn);
    f.import_all();
    const Experiment e = read_experiment(f.out / "thymio_vicon_motion");
    const double count = 1e-5, axle = e.nominal.at("robot.axle_length");
    const double left = e.runs[0].column("steps_left").back() * count;
    const double right = e.runs[0].column("steps_right").back() * count;
    CHECK((left + right) / 2 == Approx(0.75).epsilon(1e-3));
    CHECK((right - left) / axle == Approx(1.5).epsilon(1e-6));
    put(f.in / "run_1/odom_pose.txt", "1 2\n3 4\n");
    CHECK_THAT(f.error(), Contains("odom_pose.txt") && Contains("2 rows") && Contains("31"));
}

TEST_CASE("durations of loops become arrival times") {
    const Folder f;
    std::string a = "[", b = "[";
    for (int i = 0; i < 20; ++i)
        a += fmt::format("{}{}", i ? "," : "", 0.01 + 0.001 * (i % 3)),
            b += fmt::format("{}0.002", i ? "," : "");
    put(f.in / "1_go_on_benchmark/data/results_go_on_wifi_x.json",
        fmt::format("{{\"send\": {}], \"check\": {}], \"image\": [0.5, 0.5]}}", a, b));
    f.import_all();
    const Experiment e = read_experiment(f.out / "unifr_timing_wifi");
    REQUIRE(e.runs[0].rows == 20);
    CHECK(e.runs[0].column("t_host_s")[1] == Approx(0.012 + 0.013));
    CHECK(e.runs[0].column("nominal_period")[0] == Approx(0.013).margin(5e-4));
    put(f.in / "1_go_on_benchmark/data/results_go_on_wifi_x.json", "{\"send\": [1, 2");
    CHECK_THAT(f.error(), Contains("results_go_on_wifi_x.json") && Contains("not what was expected"));
}

TEST_CASE("a box's turn gives each sensor distance and incidence") {
    const Folder f;
    std::string text = "turn_deg,ps0,ps1,ps2,ps3,ps4,ps5,ps6,ps7\n";
    for (int turn = 0; turn < 360; turn += 10)
        text += fmt::format("{},{},60,60,3000.5,3100,60,60,60\n", turn, turn == 170 ? 3000 : 60 + turn % 20);
    put(f.in / "proximity_by_turn.csv", text);
    f.import_all();
    const WrittenExperiment made = f.import_all().front();
    REQUIRE(made.runs.size() == 8);
    // At turn 0 the box is behind: sensors 3 and 4 face it, sensor 0 sees nothing.
    const auto column = [&](std::size_t run, std::size_t c) { return made.runs[run].columns[c].values; };
    CHECK(column(3, 1)[0] < 0.02);
    CHECK(column(0, 1)[0] == 1.0);
    CHECK(std::fabs(column(0, 2)[16]) < 0.2);  // 160 degrees on, sensor 0 (-17 degrees) faces it within 3
    // Imported again is the same again; what somebody edited stays.
    const fs::path edited = f.out / "epuck1_box_bearing/experiment.toml";
    std::ofstream(edited, std::ios::app) << "# by hand\n";
    CHECK_THAT(f.error(), Contains("edited"));
    std::ifstream again(edited);
    CHECK_THAT(std::string(std::istreambuf_iterator<char>(again), {}), Contains("by hand"));
}

TEST_CASE(
    "a published table of log-normal fits becomes a row a distance, a copied line is reported and left out") {
    const Folder f;
    put(f.in / "rab_lognormal_iridia.csv", "distance_cm,mu,sigma\n2,7.59652,0.319231\n30,6.91745,0."
                                           "121653\n60,6.82855,0.141843\n80,6.82855,0.141843\n");
    f.import_all();
    const Experiment e = read_experiment(f.out / "argos3_epuck_rab");
    REQUIRE(e.runs.size() == 1);
    REQUIRE(e.runs[0].rows == 3);
    CHECK(e.runs[0].column("distance_m")[2] == Approx(0.6));
    CHECK(e.runs[0].column("strength")[0] == Approx(std::exp(7.59652)));
    std::string told;
    for (const std::string& caution : e.cautions)
        told += caution;
    CHECK_THAT(told, Contains("row 4 of run strength_by_distance repeats row 3 of run"));
}

TEST_CASE("what is no known set is told with what is known") {
    const Folder f;
    CHECK_THAT(f.error(), Contains("is not a folder"));
    put(f.in / "notes.txt", "nothing");
    CHECK_THAT(f.error(), Contains("holds no data set known here") && Contains("landmark.csv"));
    try {
        importers::importer_for(f.in, "roh_ir_baering");
        FAIL("accepted");
    } catch (const InputError& e) {
        CHECK_THAT(e.what(), Contains("did you mean \"roh_ir_bearing\""));
    }
}

TEST_CASE("all published sets are imported and read back") {
    const char* measured = std::getenv("PUCKLOOP_MEASURED");
    if (measured == nullptr) {
        WARN("skipped: PUCKLOOP_MEASURED is not set");
        return;
    }
    const Folder f;
    std::size_t experiments = 0;
    for (const importers::Importer& importer : importers::importers()) {
        if (std::string(importer.name) == "puckloop_density") continue;  // a table of `puckloop bench`
        const auto made = importers::import_set(fs::path(measured) / importer.name, "", f.out);
        CHECK_FALSE(made.empty());
        for (const auto& e : made) {
            INFO(e.folder);
            const Experiment read = read_experiment(f.out / e.folder);
            const bool copied = e.folder == "argos3_epuck_rab";  // its 80 cm are its 60 cm
            CHECK(read.runs.size() == e.runs.size());
            if (copied) CHECK(read.rows() == 8);
            for (const std::string& caution : read.cautions)
                CHECK((copied || caution.find("copied") == std::string::npos));
            ++experiments;
        }
    }
    CHECK(experiments == 11);
}
