#pragma once
// tams.csv: what each booth's beams and lights were, when.

#include "physics/world/recorder.h"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::physics {

/// "t_s,tam,front,back,right_red,right_green,...,top_blue": the interrupted shares of the two beams, then the
/// duty of each LED, 0..1. A row for each booth at time 0, then one where something has changed.
class BoothRecord {
  public:
    /// Throws RunError, as after_step() does.
    BoothRecord(const std::string& path, const WorldModel& world);
    void after_step(const WorldModel& world);

  private:
    struct Row {
        std::array<double, booth::kBarriers> barriers{};
        std::array<ColouredLight, booth::kLights> lights{};
        friend bool operator==(const Row&, const Row&) = default;
    };
    static Row row_of(const BoothModel& booth);
    void write(const WorldModel& world, std::size_t index);

    CsvFile file_;
    std::vector<Row> last_;  // of each booth
};

/// A booth's colour from `seconds` on, the brightest of its lights.
struct BoothColour {
    double seconds = 0.0, red = 0.0, green = 0.0, blue = 0.0;
};
struct BoothColours {
    std::string name;
    std::vector<BoothColour> colours;
};

/// Reads the file back. A broken last line is ignored, a broken line elsewhere or a missing file throws
/// RunError.
std::vector<BoothColours> read_booth_colours(const std::filesystem::path& file);

}  // namespace puckloop::physics
