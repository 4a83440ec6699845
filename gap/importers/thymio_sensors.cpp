// thymio_sensors_resilient-swarms: Thymio II proximity sensors in light and darkness, ground sensors over
// several floors, accelerometer while driving. From resilient-swarms/thymio, MIT.
//
// Proximity: a row a distance ("7cm", then 100 readings), longest distance first, so distance and order of
// measuring cannot be told apart. `sensor_readings.csv` names neither sensor nor light and is left out.
// Ground: no grey of any floor is given. The left sensor is taken as the reference: a floor's `grey` is the
// left sensor's mean over it (all directions) / 1000, so what is found compares sensors and directions, not
// floors. Accelerometer: the first row of each file (all zero at t = 0) is a placeholder and is left out.

#include "base/error.h"
#include "gap/importers/importers.h"
#include "gap/importers/text_table.h"
#include "gap/stats/robust.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>

namespace puckloop::gap::importers {

namespace {

constexpr const char *kProximity = "proximity_sensor*.csv", *kGround = "ground_sensor_readings*.csv";
constexpr double kGroundScale = 1000;        // counts of a Thymio ground sensor at most
constexpr double kCountsPerG = 23;           // of a Thymio II's accelerometer, by its makers
constexpr double kSmallestReading = 1e-100;  // the desk file holds denormal numbers where cells were empty

WrittenExperiment described(const char* folder, const char* kind, const char* title,
                            const char* description) {
    WrittenExperiment e;
    e.folder = folder;
    e.kind = kind;
    e.title = title;
    e.robot = "Thymio II";
    e.description = description;
    e.source = "github.com/resilient-swarms/thymio";
    e.licence = "MIT";
    return e;
}

/// "7cm" in metres.
double labelled_distance(const std::filesystem::path& file, const TextRow& row) {
    double value = 0;
    const std::string& text = row.cells.front();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || std::string_view(end) != "cm" || value < 0)
        throw InputError(file.string(), fmt::format("line {}", row.line),
                         fmt::format("begins with \"{}\"", text.substr(0, 20)), "a distance such as 7cm");
    return value / 100;
}

WrittenRun proximity_run(const std::filesystem::path& file) {
    const std::string name = file.stem().string();  // proximity_sensor02_readings_light
    const auto digits = name.find("sensor") + 6;
    WrittenRun run;
    run.name = name;
    const bool light = name.ends_with("light");
    if (!light && !name.ends_with("darkness"))
        throw InputError(file.string(), "", "does not tell light or darkness in its name",
                         "proximity_sensorNN_readings_light.csv");
    run.constants["ambient"] = light ? 1 : 0;
    run.constants["sensor"] = number_in(file, {0, {name.substr(digits, 2)}}, 0);
    run.conditions["light"] = light ? "light" : "dark";
    for (const TextRow& row : read_rows(file, ',')) {
        const double distance = labelled_distance(file, row);
        for (std::size_t i = 1; i < row.cells.size(); ++i)
            if (!row.cells[i].empty())
                run.row({{"order", static_cast<double>(run.rows())},
                         {"distance_m", distance},
                         {"reading", number_in(file, row, i)}});
    }
    return run;
}

/// Left and right columns of every floor in one file; the header's first line names the left ones.
void read_ground(const std::filesystem::path& file, std::vector<WrittenRun>& runs) {
    const std::vector<TextRow> rows = read_rows(file, ',');
    if (rows.size() < 3) throw InputError(file.string(), "", "is too short", "two header lines and readings");
    const std::string stem = file.stem().string();
    const std::string light = stem.find("LEDsOFF") != std::string::npos  ? "body lights off"
                              : stem.find("_dark") != std::string::npos  ? "dark"
                              : stem.find("_light") != std::string::npos ? "light"
                                                                         : "";
    for (std::size_t c = 0; c + 1 < rows[0].cells.size(); c += 2) {
        const std::string& floor = rows[0].cells[c];
        if (floor.empty()) continue;
        WrittenRun run;
        const auto prefix = std::string("ground_sensor_readings").size();
        run.name = "floor_" + floor + (stem.size() > prefix ? stem.substr(prefix) : "");
        std::string surface = floor;
        for (const char* way : {"east", "north", "west", "south"})
            if (surface.ends_with(way)) {
                surface.resize(surface.size() - std::string_view(way).size());
                run.conditions["direction"] = way;
            }
        run.conditions["surface"] = surface;
        if (!light.empty()) run.conditions["light"] = light;
        for (const std::size_t side : {0, 1})
            for (std::size_t r = 2; r < rows.size(); ++r) {
                if (c + side >= rows[r].cells.size() || rows[r].cells[c + side].empty()) continue;
                const double value = number_in(file, rows[r], c + side);
                if (value != 0 && std::fabs(value) < kSmallestReading) continue;
                run.row({{"sensor", side == 0 ? 0 : 2}, {"reading", value}});
            }
        if (run.rows() > 0) runs.push_back(run);
    }
}

/// Adds the column `grey`: the left sensor's mean over the surface, over all its runs.
void add_reference(std::vector<WrittenRun>& runs) {
    std::map<std::string, std::vector<double>> left;
    for (const WrittenRun& run : runs)
        for (std::size_t i = 0; i < run.columns[0].values.size(); ++i)
            if (run.columns[0].values[i] == 0)
                left[run.conditions.at("surface")].push_back(run.columns[1].values[i]);
    for (WrittenRun& run : runs)
        run.constants["grey"] = stats::mean(left[run.conditions.at("surface")]) / kGroundScale;
}

WrittenRun accelerometer_run(const std::filesystem::path& file) {
    auto table = read_numbers(file, ',', 4);
    if (table[0].front() == 0 && table[1].front() == 0 && table[2].front() == 0 && table[3].front() == 0)
        for (auto& column : table)
            column.erase(column.begin());
    WrittenRun run;
    run.name = file.stem().string();
    run.conditions["driving"] =
        run.name.find("onspot") != std::string::npos ? "on the spot" : "straight runs";
    run.columns = {{"t_s", table[0]}, {"ax", table[1]}, {"ay", table[2]}, {"az", table[3]}};
    return run;
}

std::vector<WrittenExperiment> read_thymio_sensors(const std::filesystem::path& folder) {
    std::vector<WrittenExperiment> all;
    WrittenExperiment proximity = described(
        "thymio_proximity", "proximity", "Thymio II proximity sensors in light and darkness",
        "Three sensors, distances 11 to 0 cm in falling order, 100 readings each: distance and order of "
        "measuring cannot be told apart, and the readings of one placement share its error.");
    for (const auto& file : paths_like(folder, kProximity))
        proximity.runs.push_back(proximity_run(file));
    proximity.instruments.push_back({"reading", 0, NAN, 1});
    WrittenExperiment ground =
        described("thymio_ground", "ground", "Thymio II ground sensors over desk, floor, foil and nothing",
                  "No grey of any surface is given. The left sensor's mean over a surface stands for it, so "
                  "what is found compares the right sensor with the left one and directions with each other, "
                  "not floors with truth.");
    for (const auto& file : paths_like(folder, kGround))
        read_ground(file, ground.runs);
    add_reference(ground.runs);
    ground.nominal = {{"ground.black", 0}, {"ground.white", kGroundScale}, {"ground.saturation", 1023}};
    ground.instruments.push_back({"reading", 0, 1023, 1});
    WrittenExperiment acceleration =
        described("thymio_accelerometer", "accelerometer", "Thymio II accelerometer while driving",
                  "Counts of 1/23 g. What the robot did is known only from the files' names, so there is no "
                  "true acceleration: rest on level ground is assumed.");
    for (const auto& file : paths_like(folder, "acc_*.csv"))
        acceleration.runs.push_back(accelerometer_run(file));
    acceleration.nominal = {{"accelerometer.zero", 0}, {"accelerometer.gain", kCountsPerG}};
    for (const char* axis : {"ax", "ay", "az"})
        acceleration.instruments.push_back({axis, NAN, NAN, 1});
    for (WrittenExperiment* e : {&proximity, &ground, &acceleration})
        if (!e->runs.empty()) all.push_back(std::move(*e));
    return all;
}

}  // namespace

const Importer kThymioSensors{"thymio_sensors_resilient-swarms",
                              "Thymio II proximity, ground and acceleration",
                              "proximity_sensor*.csv or ground_sensor_readings*.csv",
                              "@(proximity_sensor|ground_sensor_readings)*.csv", read_thymio_sensors};

}  // namespace puckloop::gap::importers
