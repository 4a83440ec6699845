#pragma once
// Which kind of experiment: one of the built-in ones, or one that its user describes in a file
// (gap/kinds/description.h). A handle: what a built-in kind has is in the tables of columns, effects and
// models; what a described one has is in its description, which lives as long as any handle to it.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace puckloop::gap {

struct Description;

class Kind {
  public:
    enum Builtin : std::uint8_t {
        Proximity,
        Motion,
        Rab,
        Microphone,
        Ground,
        Accelerometer,
        Timing,
        Described,  ///< not built in
    };

    // A built-in kind is written as it is compared: Kind kind = Kind::Ground.
    Kind(Builtin builtin) : builtin_(builtin) {}
    explicit Kind(std::shared_ptr<const Description> description)
        : builtin_(Described), description_(std::move(description)) {}

    operator Builtin() const { return builtin_; }
    /// Only of a described kind; else nullptr.
    const Description* description() const { return description_.get(); }

  private:
    Builtin builtin_;
    std::shared_ptr<const Description> description_;
};

/// "proximity", ...; of a described kind the name that its file states.
std::string_view kind_name(const Kind& kind);
inline constexpr const char* kKindNames =
    "proximity, motion, rab, microphone, ground, accelerometer, timing or the file of a kind of your own "
    "(NAME.toml)";
/// A built-in kind. InputError at `place` of `file`, with the nearest name.
Kind kind_named(std::string_view name, std::string_view file, std::string_view place);
/// Is it a built-in kind's name?
bool is_builtin_kind(std::string_view name);

}  // namespace puckloop::gap
