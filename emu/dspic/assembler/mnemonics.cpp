#include "emu/dspic/assembler/mnemonics.h"

#include "base/text/suggest.h"

#include <algorithm>
#include <map>
#include <unordered_map>

namespace puckloop::dspic {

namespace {

constexpr std::size_t kLongestName = 16;

struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
};
using Names =
    std::unordered_map<std::string, std::vector<Candidate>, Hash, std::equal_to<>>;  // looked up only

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; });
    return result;
}

struct Tables {
    Names mnemonics;
    Names conditions;
    std::vector<std::string> spellings;  ///< sorted

    Tables();
    void add(const std::string& name, const FormCodec& codec, int byte) {
        mnemonics[name].push_back({&codec, byte});
    }
    void add_spelling(const char* name, const char* meaning) {
        const std::vector<Candidate> meant = mnemonics.at(meaning);
        std::vector<Candidate>& list = mnemonics[name];
        list.insert(list.end(), meant.begin(), meant.end());
    }
};

Tables::Tables() {
    for (const FormCodec& codec : codecs()) {
        const Form& form = codec.form();
        const std::string name = lower(form.mnemonic);
        const std::size_t space = name.find(' ');
        const bool file_bit = !codec.items().empty() && codec.items()[0].kind == OperandKind::FileBit;
        if (space != std::string::npos) {
            conditions[name.substr(space + 1)].push_back({&codec, -1});
        } else if (codec.has('B') || file_bit) {
            add(name, codec, 0);
            add(name + ".w", codec, 0);
            add(name + ".b", codec, 1);
        } else {
            add(name, codec, -1);
            if (name.find('.') == std::string::npos && !codec.items().empty() && form.cycles == 1)
                add(name + ".w", codec, -1);
        }
    }
    conditions["geu"] = conditions.at("c");
    conditions["ltu"] = conditions.at("nc");
    // Without a suffix the bit tests and the bit write concern Z; .S and .U are 16-bit divisions.
    add_spelling("btst", "btst.z");
    add_spelling("btsts", "btsts.z");
    add_spelling("bsw", "bsw.z");
    add_spelling("div.s", "div.sw");
    add_spelling("div.u", "div.uw");
    add_spelling("daw", "daw.b");
    for (const auto& [name, list] :
         std::map<std::string, std::vector<Candidate>>(mnemonics.begin(), mnemonics.end()))
        spellings.push_back(name);
    spellings.push_back("bra");
}

const Tables& tables() {
    static const Tables instance;
    return instance;
}

const std::vector<Candidate>* find_in(const Names& names, std::string_view name) {
    char buffer[kLongestName];
    if (name.size() > kLongestName) return nullptr;
    for (std::size_t i = 0; i < name.size(); ++i)
        buffer[i] = name[i] >= 'A' && name[i] <= 'Z' ? static_cast<char>(name[i] + ('a' - 'A')) : name[i];
    const auto found = names.find(std::string_view(buffer, name.size()));
    return found == names.end() ? nullptr : &found->second;
}

}  // namespace

const std::vector<Candidate>* find_mnemonic(std::string_view name) {
    return find_in(tables().mnemonics, name);
}

const std::vector<Candidate>* find_condition(std::string_view name) {
    return find_in(tables().conditions, name);
}

std::string nearest_mnemonic(std::string_view name) {
    return nearest_name(name, {tables().spellings.begin(), tables().spellings.end()});
}

}  // namespace puckloop::dspic
