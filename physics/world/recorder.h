#pragma once
// What a run leaves on disk about the world: trajectory.csv, sensors.csv, where things move or are moved
// objects.csv, and where robots lay trails pheromones.csv. Every row is flushed as it is written, so that a
// run that dies keeps its data.

#include "physics/world/world_model.h"

#include <cstdio>
#include <memory>
#include <string>

namespace puckloop::physics {

/// A text file that reports it when the disk is full. Throws RunError.
class CsvFile {
  public:
    CsvFile(std::string path, const std::string& header);
    void row(const std::string& text);
    void flush();

    /// From here on rows are kept back, until settle() writes them or rewind() drops them. A mark set before
    /// is settled.
    void mark();
    void rewind() { kept_back_.clear(); }
    void settle();

  private:
    struct Closer {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    [[noreturn]] void fail() const;

    std::string path_;
    std::unique_ptr<std::FILE, Closer> file_;
    bool marked_ = false;
    std::string kept_back_;
};

class Recorder {
  public:
    /// Opens the files in world.description().recording.directory and writes the rows of time 0.
    explicit Recorder(const WorldModel& world);
    /// After each step; writes when the period has passed.
    void after_step(const WorldModel& world);
    /// What trails are left.
    void end(const WorldModel& world);

  private:
    void write(const WorldModel& world);
    void write_objects(const WorldModel& world);
    void write_trail(const WorldModel& world, const PheromoneField& trail);
    void object_row(const WorldModel& world, const std::string& name, double x, double y, double heading);

    std::uint64_t period_steps_;
    CsvFile trajectory_;
    CsvFile sensors_;
    std::unique_ptr<CsvFile> objects_;  // from the first one on
    std::unique_ptr<CsvFile> trails_;   // where there are any
};

}  // namespace puckloop::physics
