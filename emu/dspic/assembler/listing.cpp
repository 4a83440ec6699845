#include "emu/dspic/assembler/listing.h"

#include "emu/dspic/assembler/codec.h"
#include "emu/dspic/assembler/disassembler.h"
#include "emu/dspic/assembler/expression.h"
#include "emu/dspic/assembler/operand.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace puckloop::dspic {

namespace {

constexpr std::uint32_t kFlashEnd = 0x7FF000;  // data EEPROM, configuration and the rest lie above
constexpr std::size_t kCommentColumn = 48;
constexpr std::size_t kIndent = 8;
constexpr std::size_t kShortestFill = 4;

struct Item {
    std::uint32_t address = 0;
    std::uint32_t word = 0;
    std::uint32_t next = 0;
    int length = 1;
    bool data = false;
};

class Lister {
  public:
    Lister(const std::map<std::uint32_t, std::uint32_t>& words, const ListingOptions& options)
        : words_(words),
          options_(options),
          label_of_([this](std::uint32_t address) { return label(address); }) {}

    std::string run() {
        sweep();
        choose_labels();
        std::uint32_t expected = 0;
        for (std::size_t i = 0; i < items_.size();) {
            const Item& item = items_[i];
            if (item.address != expected) text_ += fmt::format("\n        .org      {:#x}\n", item.address);
            write_labels(item.address);
            const std::size_t repeats = run_length(i);
            if (repeats >= kShortestFill) {
                write_line(fmt::format(".pfill    {}, {:#x}", repeats, item.word), item, false);
                i += repeats;
            } else {
                write_item(item);
                ++i;
            }
            expected = items_[i - 1].address + 2 * static_cast<std::uint32_t>(items_[i - 1].length);
        }
        return std::move(text_);
    }

  private:
    bool is_data(std::uint32_t address, std::uint32_t word) const {
        if (address >= kFlashEnd || (address >= 4 && address < options_.vectors_end)) return true;
        const Form* form = find_form(word);
        return !form || (form->id == FormId::NOP && word != 0) ||
               (form->id == FormId::NOPR && word != 0xFF0000);
    }

    void sweep() {
        for (auto at = words_.lower_bound(options_.start); at != words_.end() && at->first <= options_.end;) {
            Item item{at->first, at->second, 0, 1, is_data(at->first, at->second)};
            ++at;
            const bool follows =
                at != words_.end() && at->first == item.address + 2 && at->first <= options_.end;
            if (!item.data && find_form(item.word)->two_words()) {
                if (follows) item.length = length_of(item.word, at->second);
                item.data = item.length == 1;
                if (item.length == 2) {
                    item.next = at->second;
                    ++at;
                }
            }
            items_.push_back(item);
        }
    }

    void choose_labels() {
        std::set<std::uint32_t> starts;
        for (const Item& item : items_)
            starts.insert(item.address);
        std::set<std::string> taken;
        for (const auto& [address, name] : options_.labels) {
            const bool fit = !name.empty() && name.size() <= 100 && is_name_start(name[0]) && name != "." &&
                             name != "$" && std::all_of(name.begin(), name.end(), is_name_char) &&
                             !is_reserved_name(name);
            if (fit && starts.count(address) && taken.insert(name).second) labels_.emplace(address, name);
        }
        // A first walk with a label function that notes every target asked for.
        const LabelOf note = [&](std::uint32_t target) -> std::string_view {
            const std::string name = fmt::format("L_{:06x}", target);
            if (starts.count(target) && !labels_.count(target) && taken.insert(name).second)
                labels_.emplace(target, name);
            return {};
        };
        for (const Item& item : items_) {
            if (item.data) continue;
            InstructionText ignored;
            disassemble(item.word, item.next, item.address, ignored, &note);
        }
    }

    std::string_view label(std::uint32_t address) const {
        const auto found = labels_.find(address);
        return found == labels_.end() ? std::string_view{} : found->second;
    }

    void write_labels(std::uint32_t address) {
        const auto [first, last] = labels_.equal_range(address);
        for (auto at = first; at != last; ++at)
            text_ += fmt::format("{}:\n", at->second);
    }

    std::size_t run_length(std::size_t i) const {
        std::size_t length = 1;
        const Item& first = items_[i];
        while (i + length < items_.size() && first.length == 1) {
            const Item& item = items_[i + length];
            if (item.word != first.word || item.length != 1 || labels_.count(item.address) ||
                item.address != first.address + 2 * length)
                break;
            ++length;
        }
        return length;
    }

    void write_line(std::string_view content, const Item& item, bool second) {
        const std::size_t start = text_.size();
        text_.append(kIndent, ' ');
        text_ += content;
        const std::size_t used = text_.size() - start;
        text_.append(used < kCommentColumn ? kCommentColumn - used : 1, ' ');
        text_ += fmt::format("; {:06x}: {:06x}", item.address, item.word);
        if (second) text_ += fmt::format(" {:06x}", item.next);
        text_ += '\n';
    }

    void write_item(const Item& item) {
        InstructionText content;
        if (item.data) {
            content.put(".pword    ");
            const bool vector = item.address >= 4 && item.address < options_.vectors_end;
            const std::string_view name = vector ? label(item.word) : std::string_view{};
            if (name.empty())
                content.put_hex(item.word);
            else
                content.put(name);
        } else {
            disassemble(item.word, item.next, item.address, content, &label_of_);
        }
        write_line(content.view(), item, item.length == 2);
    }

    const std::map<std::uint32_t, std::uint32_t>& words_;
    const ListingOptions& options_;
    LabelOf label_of_;
    std::vector<Item> items_;
    std::multimap<std::uint32_t, std::string> labels_;
    std::string text_;
};

}  // namespace

std::string list_program(const std::map<std::uint32_t, std::uint32_t>& words, const ListingOptions& options) {
    return Lister(words, options).run();
}

}  // namespace puckloop::dspic
