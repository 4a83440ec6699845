// A described kind as a model: means by hand, numbers for each sensor, [nominal], what is missing.

#include "base/error.h"
#include "gap/importers/importers.h"
#include "gap/kinds/read_kind.h"
#include "gap/models/model.h"
#include "gap/reading/read_experiment.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>

using namespace puckloop::gap;
using Catch::Matchers::Contains;

namespace {

const std::string kSource = PUCKLOOP_SOURCE;

/// A folder with the shipped distance sensor and one table.
std::filesystem::path folder_with(const std::string& toml, const std::string& csv) {
    const auto folder = puckloop::tests::scratch_path("ir");
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    std::filesystem::copy_file(kSource + "/scenarios/kinds/ir_distance.toml", folder / "ir_distance.toml");
    std::ofstream(folder / "experiment.toml") << "kind = \"ir_distance.toml\"\n"
                                              << toml << "[[run]]\nfile = \"a.csv\"\n";
    std::ofstream(folder / "a.csv") << csv;
    return folder;
}

constexpr const char* kTable =
    "t_s,sensor,distance_m,temperature_c,reading\n"
    "0,1,0.1,25,500\n0.1,3,0.2,25,270\n0.2,1,0.3,45,190\n0.3,3,0.4,,150\n0.4,1,0.5,5,\n";

double at(const Model& model, std::vector<double> values, const char* name, double value, std::size_t row) {
    values[model.find(name).value()] = value;
    return model.predicted(values)[0].mean[row];
}

}  // namespace

TEST_CASE("means are the formula's, row by row, each sensor with its own numbers") {
    const Experiment experiment = read_experiment(folder_with("", kTable));
    const auto model = make_model(experiment);
    REQUIRE(model->observables().size() == 1);
    const Observable& reading = model->observables()[0];
    REQUIRE(reading.y.size() == 4);  // sensor 1: rows 1 and 3; sensor 3: rows 2 and 4
    CHECK(reading.row == std::vector<std::uint32_t>{0, 2, 1, 3});
    CHECK(reading.instrument.ceiling == 1023);
    const auto neutral = model->neutral();
    const auto mean = model->predicted(neutral)[0].mean;
    CHECK(mean[0] == Approx(60 / 0.12));
    CHECK(mean[1] == Approx(60 / 0.32));
    CHECK(mean[2] == Approx(60 / 0.22));
    CHECK(model->matching("ir_distance.gain*").size() == 2);
    CHECK(at(*model, neutral, "ir_distance.gain3", 2.0, 2) == Approx(2 * mean[2]));
    CHECK(at(*model, neutral, "ir_distance.gain3", 2.0, 0) == mean[0]);
    CHECK(at(*model, neutral, "ir_distance.drift", 0.01, 1) == Approx(1.2 * mean[1]));
    CHECK(at(*model, neutral, "ir_distance.drift", 0.01, 0) == mean[0]);  // 25 degC
}

TEST_CASE("[nominal] states a described kind's numbers by their full names") {
    const Experiment experiment =
        read_experiment(folder_with("[nominal]\n\"ir_distance.offset\" = 7\n", kTable));
    CHECK(make_model(experiment)->predicted(make_model(experiment)->neutral())[0].mean[0] == Approx(507));
    const Experiment wrong = read_experiment(folder_with("[nominal]\n\"ir_distance.ofset\" = 7\n", kTable));
    CHECK_THROWS_WITH(make_model(wrong), Contains("ir_distance.offset"));
}

TEST_CASE("what an experiment of a described kind lacks is said with the file") {
    CHECK_THROWS_WITH(read_experiment(folder_with("", "t_s,reading\n0,1\n")), Contains("distance_m"));
    CHECK_THROWS_WITH(read_experiment(folder_with("", "distance_m,reading,sensor\n0.1,500,1.5\n0.2,300,0\n")),
                      Contains("is not whole"));
    CHECK_THROWS_WITH(read_experiment(folder_with("", "distance_m,reading\n10,500\n20,300\n30,280\n")),
                      Contains("distance_m = 10 m is impossible") && Contains("cm"));
}

TEST_CASE("the table of bench density becomes single frames with the same shares") {
    const auto folder = puckloop::tests::scratch_path("density");
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "density.csv")
        << "setting,robots,bytes,runs,from_m,to_m,frames,heard,steps,steps_heard,lost_collision\n"
           "default,2,1,20,0,0.25,50,40,0,0,10\ndefault,2,1,20,0.25,0.5,0,0,0,0,0\n"
           "for swarms,20,4,2,0,0.25,4000,400,0,0,3600\n";
    const auto made = importers::import_set(folder, "", folder / "out");
    REQUIRE(made.size() == 1);
    const Experiment experiment = read_experiment(folder / "out" / "rab_reception");
    REQUIRE(experiment.runs.size() == 2);
    CHECK(experiment.runs[0].rows == 50);
    CHECK(experiment.runs[1].rows == 100);
    double heard = 0;
    for (const double one : experiment.runs[1].column("received"))
        heard += one;
    CHECK(heard == 10);
    CHECK(experiment.runs[1].condition("setting") == "for swarms");
    CHECK(experiment.runs[1].column("robots").front() == 20);
    const auto model = make_model(experiment);
    CHECK(model->predicted(model->neutral())[0].mean[0] == Approx(0.7).epsilon(1e-6));

    std::ofstream(folder / "density.csv") << "setting\ndefault,2,1,20,0,0.25,50,60,0,0\n";
    CHECK_THROWS_WITH(importers::import_set(folder, "", folder / "other"), Contains("line 2"));
}
