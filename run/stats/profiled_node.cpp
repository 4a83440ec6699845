#include "run/stats/profiled_node.h"

#include "debug/profile.h"
#include "emu/avr/chip/chip.h"
#include "emu/avr/devices/device.h"
#include "emu/image/avr_image.h"
#include "emu/image/image.h"
#include "emu/image/symbol_sizes.h"
#include "emu/tam_avr/tam_node.h"
#include "run/stats/board_chip.h"

#include <nlohmann/json.hpp>

#include <utility>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

/// What an image calls its places and variables.
struct Names {
    debug::Places places;
    debug::Variables variables;
};

Names names_in(const std::string& firmware, bool avr, const debug::DebugChip& chip) {
    std::map<std::string, image::Symbol> symbols;
    image::LineTable lines;
    if (avr) {
        image::AvrImage image = image::load_avr_image(firmware, avr::atmega1284p().image_part());
        symbols = std::move(image.symbols);
        lines = std::move(image.lines);
    } else {
        symbols = image::load_image(firmware).symbols;
        lines = image::source_lines(firmware);
    }
    return {debug::Places(symbols, std::move(lines)),
            debug::Variables(symbols, image::symbol_sizes(firmware), chip.ram_start(), chip.ram_end(),
                             !chip.stack_grows_up())};
}

class ProfiledNode final : public cosim::StatefulNode {
  public:
    ProfiledNode(std::unique_ptr<cosim::StatefulNode> board, const std::string& firmware)
        : board_(std::move(board)),
          chip_(chip_of(*board_).chip),
          names_(names_in(firmware, dynamic_cast<tam::TamNode*>(board_.get()) != nullptr, *chip_)),
          profile_(*chip_) {
        chip_->set_instrument(&profile_, true);
    }

    std::string_view name() const override { return board_->name(); }
    std::span<const cosim::Port> ports() const override { return board_->ports(); }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override {
        board_->advance(until, inbox, outbox);
    }
    cosim::Time earliest_output(cosim::PortIndex port) const override {
        return board_->earliest_output(port);
    }
    cosim::Time lookahead(cosim::PortIndex port) const override { return board_->lookahead(port); }
    std::optional<cosim::Time> begun(cosim::PortIndex port) const override { return board_->begun(port); }
    void state(StateWriter& archive) const override {
        const cosim::StatefulNode& board = *board_;
        board.state(archive);
    }
    void state(StateReader& archive) override { board_->state(archive); }
    void renew_random_streams() override { board_->renew_random_streams(); }
    // It does not go back (rewindable()): what is executed counts once.

    std::string finish() override {
        chip_->set_instrument(nullptr, false);
        profile_.finish(chip_->cycle());
        ordered_json report = ordered_json::parse(board_->finish());
        report["stats"] =
            ordered_json::parse(profile_json(profile_, names_.places, names_.variables, *chip_));
        const std::string warning = stack_warning(profile_, names_.variables, *chip_);
        if (!warning.empty()) report["warnings"].push_back(warning);
        return report.dump();
    }

  private:
    std::unique_ptr<cosim::StatefulNode> board_;
    std::unique_ptr<debug::DebugChip> chip_;
    Names names_;
    debug::Profile profile_;
};

}  // namespace

std::unique_ptr<cosim::StatefulNode> make_profiled(std::unique_ptr<cosim::StatefulNode> board,
                                                   const std::string& firmware) {
    return std::make_unique<ProfiledNode>(std::move(board), firmware);
}

}  // namespace puckloop::tools
