#include "emu/avr/assembler/listing.h"

#include "emu/assembly/text.h"
#include "emu/avr/assembler/disassembler.h"
#include "emu/avr/assembler/encoder.h"
#include "emu/avr/isa/operands.h"

#include <fmt/format.h>

#include <iterator>
#include <optional>
#include <set>

namespace puckloop::avr {

namespace {

constexpr int kCommentColumn = 40;

class Listing {
  public:
    Listing(const std::vector<image::ByteSegment>& segments, const ListingOptions& options)
        : options_(options) {
        for (const image::ByteSegment& segment : segments)
            for (std::size_t i = 0; i < segment.bytes.size(); ++i) {
                const std::uint64_t address = segment.address + i;
                if (address >= options.start && address <= options.end && address < kProgramBytes)
                    bytes_[static_cast<std::uint32_t>(address)] = segment.bytes[i];
            }
        for (const auto& [address, name] : options.labels)
            if (assembly::is_name(name) && register_number(name) < 0 && names_taken_.insert(name).second)
                names_.emplace(address, name);
    }

    std::string text() {
        each_piece([this](const Piece& piece) { note(piece); });
        for (const std::uint32_t target : targets_)
            if (starts_.contains(target) && !names_.contains(target))
                names_.emplace(target, fmt::format("L_{:x}", target));
        std::string out;
        std::uint32_t expected = kProgramBytes;
        each_piece([&](const Piece& piece) {
            if (piece.address != expected) out += fmt::format("        .org 0x{:x}\n", piece.address);
            expected = piece.address + piece.bytes;
            for (auto [name, last] = names_.equal_range(piece.address); name != last; ++name)
                out += fmt::format("{}:\n", name->second);
            out += fmt::format("        {:<{}}; {:05x}: {:04x}", piece.text, kCommentColumn - 8,
                               piece.address, piece.word);
            if (piece.bytes == 4) out += fmt::format(" {:04x}", piece.next);
            out += '\n';
        });
        return out;
    }

  private:
    /// An instruction, or a byte without its other half.
    struct Piece {
        std::uint32_t address = 0;
        std::uint32_t bytes = 0;
        std::uint16_t word = 0, next = 0;
        std::string text;
    };

    std::optional<std::uint16_t> word_at(std::uint32_t address) const {
        const auto low = bytes_.find(address), high = bytes_.find(address + 1);
        if (low == bytes_.end() || high == bytes_.end()) return std::nullopt;
        return static_cast<std::uint16_t>(low->second | high->second << 8);
    }

    template <class Take>
    void each_piece(Take take) const {
        const LabelOf name_of = [this](std::uint32_t target) {
            const auto name = names_.find(target);
            return name == names_.end() || !starts_.contains(target) ? std::string{} : name->second;
        };
        for (auto at = bytes_.begin(); at != bytes_.end();) {
            Piece piece;
            piece.address = at->first;
            const auto word = word_at(piece.address);
            if (piece.address & 1 || !word) {
                piece.bytes = 1;
                piece.word = at->second;
                piece.text = fmt::format(".byte 0x{:02x}", at->second);
            } else {
                const auto next = word_at(piece.address + 2);
                const Disassembled instruction =
                    disassemble(*word, next.value_or(0), next.has_value(), piece.address, name_of);
                piece.bytes = 2 * static_cast<std::uint32_t>(instruction.words);
                piece.word = *word;
                piece.next = next.value_or(0);
                piece.text = instruction.text;
            }
            take(piece);
            std::advance(at, piece.bytes);
        }
    }

    /// First pass: where instructions begin and where branches lead.
    void note(const Piece& piece) {
        starts_.insert(piece.address);
        const Form* form = piece.text.starts_with('.') ? nullptr : find_form(piece.word);
        if (!form) return;
        for (const OperandSpec& operand : operands_of(form->id).list()) {
            const std::uint32_t field = form->field('k', piece.word, piece.next);
            if (operand.kind == OperandKind::Relative)
                targets_.insert(2 * relative_target(piece.address / 2, field, form->width('k')));
            if (operand.kind == OperandKind::Program) targets_.insert(2 * field);
        }
    }

    const ListingOptions& options_;
    std::map<std::uint32_t, std::uint8_t> bytes_;
    std::multimap<std::uint32_t, std::string> names_;
    std::set<std::string> names_taken_;
    std::set<std::uint32_t> starts_, targets_;
};

}  // namespace

std::string list_program(const std::vector<image::ByteSegment>& segments, const ListingOptions& options) {
    return Listing(segments, options).text();
}

}  // namespace puckloop::avr
