#include "emu/board/fault_parts.h"

#include "base/json.h"
#include "emu/image/avr_image.h"
#include "emu/image/image.h"

#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <utility>

namespace puckloop::board {

namespace {

/// Of data symbols; functions go through find_code().
std::function<std::optional<std::uint32_t>(const std::string&)>
data_of(std::map<std::string, image::Symbol> symbols) {
    return [symbols = std::move(symbols)](const std::string& name) -> std::optional<std::uint32_t> {
        for (const std::string& spelling : {name, "_" + name})
            if (const auto found = symbols.find(spelling);
                found != symbols.end() && found->second.space == image::Space::Data)
                return found->second.address;
        return std::nullopt;
    };
}

template <class Image>
chip::Symbols symbols_in(const Image& image) {
    return {[image](const std::string& name) { return image.find_code(name); }, data_of(image.symbols)};
}

}  // namespace

chip::Symbols symbols_of(const image::Image& image) {
    return symbols_in(image);
}
chip::Symbols symbols_of(const image::AvrImage& image) {
    return symbols_in(image);
}

std::unique_ptr<chip::BoardFaults> make_faults(const std::vector<cosim::CarriedFault>& faults,
                                               const FaultSites& sites, const chip::Symbols& symbols) {
    std::vector<cosim::CarriedFault> analog, others;
    for (const cosim::CarriedFault& fault : faults)
        (chip::AnalogFaults::takes(fault.spec.kind) ? analog : others).push_back(fault);
    sites.analog.begin(std::move(analog), sites.clock, sites.origin);
    return std::make_unique<chip::BoardFaults>(std::move(others), sites.chip, sites.board, symbols, sites.ppm,
                                               sites.origin);
}

nlohmann::ordered_json fault_report(const chip::BoardFaults& faults, const chip::AnalogFaults& analog,
                                    cosim::Time end) {
    std::vector<cosim::CarriedFault> all = faults.faults();
    all.insert(all.end(), analog.faults().begin(), analog.faults().end());
    return cosim::fault_results(all, end);
}

void save_faults(StateWriter& archive, const chip::BoardFaults* faults) {
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    if (faults != nullptr && !faults->faults().empty()) writer(*faults);
    archive(bytes);
}

void load_faults(StateReader& archive, std::unique_ptr<chip::BoardFaults>& faults, cosim::Time now,
                 const std::function<std::unique_ptr<chip::BoardFaults>()>& make_none) {
    std::vector<std::uint8_t> bytes;
    archive(bytes);
    if (!faults && !bytes.empty()) faults = make_none();
    if (!faults) return;
    if (!bytes.empty()) {
        StateReader reader(bytes);
        reader(*faults);
        reader.end();
    }
    faults->loaded(now, !bytes.empty());
}

}  // namespace puckloop::board
