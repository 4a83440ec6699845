#pragma once
// A struct that describes something lists its fields once:
//
//     struct Lamp {
//         double height = 0.5;
//         std::string name;
//         template <class Visitor>
//         static constexpr auto fields(Visitor&& visit) {
//             return visit(field("height_m", &Lamp::height, "of the light above the floor").in("m").above(0),
//                          field("name", &Lamp::name, "in reports").required());
//         }
//     };
//     static_assert(lists_all_fields<Lamp>);
//
// All else is a visitor of that list: json.h writes and reads a struct and compares two of them, table.h
// gives the rows of a documentation table and a JSON Schema. A field's default is its member's
// initialiser and is nowhere else. The list is in the order of the members; one that misses a member does not
// compile.

#include <cstddef>
#include <limits>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

namespace puckloop {

/// What two descriptions are compared for.
enum class Comparison {
    State,  ///< of a board: does a saved state go on as it was?
    Run,    ///< of a node: is it the run of a snapshot?
};

/// A member's type decides how it is written, unless its field states another form.
struct OwnForm {};

template <class Owner, class Member, class Form = OwnForm>
struct Field {
    static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

    std::string_view key;
    Member Owner::*member;
    std::string_view about;
    std::string_view unit{};
    double least = -kNoLimit, most = kNoLimit;  ///< of a number, or of each in a list
    bool open = false;                          ///< `least` itself is out of range
    bool needed = false;
    bool in_state = true, in_run = true;  ///< counts in that comparison

    constexpr Field in(std::string_view name) const {
        Field field = *this;
        field.unit = name;
        return field;
    }
    constexpr Field within(double from, double to) const {
        Field field = *this;
        field.least = from;
        field.most = to;
        return field;
    }
    constexpr Field at_least(double from) const { return within(from, most); }
    constexpr Field above(double from) const {
        Field field = within(from, most);
        field.open = true;
        return field;
    }
    /// There is no default.
    constexpr Field required() const {
        Field field = *this;
        field.needed = true;
        return field;
    }
    /// Decides nothing of what the comparison asks, or is compared otherwise.
    constexpr Field not_in(Comparison comparison) const {
        Field field = *this;
        (comparison == Comparison::State ? field.in_state : field.in_run) = false;
        return field;
    }
    /// Written and read by `Other`: static JsonValue write(const Member&), and static void read(Member&,
    /// const JsonValue&, const std::string& place), which throws InputError.
    template <class Other>
    constexpr Field<Owner, Member, Other> as() const {
        return {key, member, about, unit, least, most, open, needed, in_state, in_run};
    }
};

template <class Owner, class Member>
constexpr Field<Owner, Member> field(std::string_view key, Member Owner::*member, std::string_view about) {
    return {key, member, about};
}

/// A member whose own fields belong to the struct's, beside the others.
template <class Owner, class Member>
struct Part {
    Member Owner::*member;
};
template <class Owner, class Member>
constexpr Part<Owner, Member> part(Member Owner::*member) {
    return {member};
}

/// A member that is no part of the description: it is nowhere but in the process that set it.
template <class Owner, class Member>
struct Unlisted {
    Member Owner::*member;
};
template <class Owner, class Member>
constexpr Unlisted<Owner, Member> unlisted(Member Owner::*member) {
    return {member};
}

namespace detail {

struct Listing {
    constexpr auto operator()(auto... entries) const { return std::tuple(entries...); }
};

template <class Entry>
struct MemberOf;
template <class O, class M, class F>
struct MemberOf<Field<O, M, F>> {
    using type = M;
};
template <class O, class M>
struct MemberOf<Part<O, M>> {
    using type = M;
};
template <class O, class M>
struct MemberOf<Unlisted<O, M>> {
    using type = M;
};

/// The members' types make the struct, and leave none over.
template <class T, class... Entries>
consteval bool complete(const std::tuple<Entries...>*) {
    return requires {
        T{std::declval<typename MemberOf<Entries>::type>()...};
    }
    &&!requires {
        T{std::declval<typename MemberOf<Entries>::type>()..., {}};
    };
}

}  // namespace detail

/// A struct with a list of its fields.
template <class T>
concept Described = requires {
    T::fields(detail::Listing{});
};

template <Described T>
using FieldList = decltype(T::fields(detail::Listing{}));

/// To be asserted behind each such struct, which is an aggregate. False: a member is missing in the list, or
/// out of order.
template <Described T>
inline constexpr bool lists_all_fields = detail::complete<T>(static_cast<FieldList<T>*>(nullptr));

/// Calls `each` with every entry of the list: a Field, Part or Unlisted.
template <Described T>
constexpr void for_each_entry(auto&& each) {
    T::fields([&](const auto&... entries) { (each(entries), ...); });
}

}  // namespace puckloop
