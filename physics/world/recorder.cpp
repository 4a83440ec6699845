#include "physics/world/recorder.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

namespace puckloop::physics {

namespace {

std::string in_directory(const WorldModel& world, const char* name) {
    return world.description().recording.directory + "/" + name;
}

std::string sensors_header() {
    std::string header = "t_s,robot";
    for (std::size_t i = 0; i < kRecordedChannels; ++i)
        header += "," + std::string(channel_name(i));
    return header + ",steps_left,steps_right";
}

/// Are a trail's rows asked for at this step?
bool is_due(const WorldModel& world, const PheromoneField& trail) {
    const auto every =
        static_cast<std::uint64_t>(std::llround(trail.description().record_every / kStepSeconds));
    return every > 0 && world.steps_done() % every == 0;
}

/// No "-0.000000".
double tidy(double value) {
    return std::abs(value) < 5e-7 ? 0.0 : value;
}

}  // namespace

CsvFile::CsvFile(std::string path, const std::string& header)
    : path_(std::move(path)), file_(new_file(path_)) {
    if (file_ == nullptr) fail();
    row(header);
    flush();
}

void CsvFile::fail() const {
    throw RunError(fmt::format("cannot write {}: {}", path_, why_not_written(errno)));
}

void CsvFile::mark() {
    settle();
    marked_ = true;
}

void CsvFile::settle() {
    marked_ = false;
    if (kept_back_.empty()) return;
    const std::string rows = std::exchange(kept_back_, {});
    if (std::fwrite(rows.data(), 1, rows.size(), file_.get()) != rows.size()) fail();
    flush();
}

void CsvFile::row(const std::string& text) {
    if (marked_) {
        kept_back_ += text + '\n';
        return;
    }
    if (std::fputs(text.c_str(), file_.get()) < 0 || std::fputc('\n', file_.get()) == EOF) fail();
}

void CsvFile::flush() {
    if (std::fflush(file_.get()) != 0) fail();
}

Recorder::Recorder(const WorldModel& world)
    : period_steps_(
          static_cast<std::uint64_t>(std::llround(world.description().recording.period / kStepSeconds))),
      trajectory_(in_directory(world, "trajectory.csv"), "t_s,robot,x_m,y_m,theta_rad"),
      sensors_(in_directory(world, "sensors.csv"), sensors_header()) {
    std::remove(in_directory(world, "objects.csv").c_str());  // of an earlier run
    std::remove(in_directory(world, "pheromones.csv").c_str());
    if (!world.trails().empty())
        trails_ = std::make_unique<CsvFile>(in_directory(world, "pheromones.csv"),
                                            "t_s,pheromone,x_m,y_m,strength");
    write(world);
}

void Recorder::after_step(const WorldModel& world) {
    if (world.steps_done() % period_steps_ == 0) write(world);
    for (const PheromoneField& trail : world.trails())
        if (is_due(world, trail)) write_trail(world, trail);
}

void Recorder::end(const WorldModel& world) {
    for (const PheromoneField& trail : world.trails())
        if (!is_due(world, trail)) write_trail(world, trail);
}

/// Squares that hold something to be seen: their middles.
void Recorder::write_trail(const WorldModel& world, const PheromoneField& trail) {
    constexpr double kSeen = 0.005;  // of full: a count or two of a ground sensor
    for (std::size_t row = 0; row < trail.rows(); ++row)
        for (std::size_t column = 0; column < trail.columns(); ++column) {
            const double value = trail.value(column, row);
            if (value < kSeen) continue;
            const Point point = trail.middle(column, row);
            trails_->row(fmt::format("{:.3f},{},{:.4f},{:.4f},{:.3f}", world.seconds(),
                                     trail.description().name, tidy(point.x), tidy(point.y), value));
        }
    trails_->flush();
}

void Recorder::write(const WorldModel& world) {
    const double t = world.seconds();
    for (std::size_t i = 0; i < world.robot_count(); ++i) {
        const auto& name = world.description().robots[i].name;
        const auto& s = world.state(i);
        trajectory_.row(
            fmt::format("{:.3f},{},{:.6f},{:.6f},{:.6f}", t, name, tidy(s.x), tidy(s.y), tidy(s.heading)));
        std::string line = fmt::format("{:.3f},{}", t, name);
        for (const double value : std::span(world.robot(i).channels()).first<kRecordedChannels>())
            line += fmt::format(",{:.3f}", tidy(value));
        for (const Side side : {Side::Left, Side::Right})
            line += fmt::format(",{:.0f}", world.robot(i).drive(side).steps());
        sensors_.row(line);
    }
    write_objects(world);
    trajectory_.flush();
    sensors_.flush();
    if (objects_) objects_->flush();
}

/// Movable things, and fixed or virtual ones that have been moved or added by hand; none that was taken away.
void Recorder::write_objects(const WorldModel& world) {
    for (std::size_t i = 0; i < world.object_names().size(); ++i)
        if (world.object_shape(i).height > 0.0)
            object_row(world, world.object_names()[i], world.object(i).x, world.object(i).y,
                       world.object(i).heading);
    for (const std::size_t i : world.fixed_by_hand()) {
        const Shape& shape = world.fixed(i);
        if (shape.height > 0.0)
            object_row(world, world.fixed_names()[i], shape.x, shape.y, std::atan2(shape.sine, shape.cosine));
    }
    for (const VirtualBody& body : world.virtual_bodies())
        if (body.by_hand)
            object_row(world, body.name, body.shape.x, body.shape.y,
                       std::atan2(body.shape.sine, body.shape.cosine));
}

void Recorder::object_row(const WorldModel& world, const std::string& name, double x, double y,
                          double heading) {
    if (!objects_)
        objects_ =
            std::make_unique<CsvFile>(in_directory(world, "objects.csv"), "t_s,object,x_m,y_m,theta_rad");
    objects_->row(fmt::format("{:.3f},{},{:.6f},{:.6f},{:.6f}", world.seconds(), name, tidy(x), tidy(y),
                              tidy(heading)));
}

}  // namespace puckloop::physics
