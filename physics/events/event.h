#pragma once
// What happens to a world while it runs: an action, and when. Plain data: written by a scenario or sent to a
// running world, checked by check_events(), carried between processes as JSON text. SI units as in
// physics/description/description.h; times are whole microseconds.

#include "cosim/core/time.h"
#include "physics/description/description.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::physics {

enum class Verb : std::uint8_t {
    Move,       ///< object to a place, at once or gliding; a robot is carried there
    Add,        ///< a new wall, box, cylinder, lamp, speaker or floor patch
    Remove,     ///< object
    Lift,       ///< robot: held in the air where it is
    Put,        ///< robot: down on the floor, where it is or elsewhere
    Set,        ///< a property of an object, of the floor or of the room's light
    SwitchOff,  ///< lamp or loudspeaker
    SwitchOn,   ///< the same, as bright or loud as before
    Select,     ///< robot: its selector to a position
    Reset,      ///< robot: its reset button
    Remote,     ///< robot, or all: a key of the remote control
    Unset,      ///< robot: its sensors see the world again, after Set of what is not there
    Tune,       ///< robot: another value of a physical parameter
    Send,       ///< computer of the network: a datagram for one of its programs
};

/// Objects of Set that are no things.
inline constexpr std::string_view kFloor = "floor";
inline constexpr std::string_view kRoomLight = "light";
/// Object of Remote: every robot in the room.
inline constexpr std::string_view kEveryRobot = "all";

/// Of Add: one of the lists has one element, the others none.
struct NewThing {
    std::vector<Wall> walls{};
    std::vector<Box> boxes{};
    std::vector<Cylinder> cylinders{};
    std::vector<Lamp> lamps{};
    std::vector<Speaker> speakers{};
    std::vector<Patch> patches{};
    VirtualThings virtuals{};  ///< no pheromones
};

struct Action {
    Verb verb = Verb::Move;
    std::string object{};             ///< name; of Add the new thing's
    std::optional<Point> to{};        ///< Move, Put
    bool relative = false;            ///< Move: `to` is a shift, not a place
    std::optional<double> heading{};  ///< Move, Put
    double over = 0.0;                ///< s, Move: how long it glides; 0: at once
    NewThing thing{};                 ///< Add
    std::string property{};  ///< Set: "grey", "ambient", "intensity", "level", "reflectivity", "charge",
                             ///< "ground": what a robot's ground sensors see in place of the floor. Tune:
                             ///< the parameter's name
    double value = 0.0;      ///< Set, Tune
    int number = 0;          ///< Select: position 0..15. Remote: key 0..63. Send: port 1..65535
    int address = 0;         ///< Remote: 0..31
    double hold = 0.0;       ///< s, Remote: how long the key is held
    std::string text{};      ///< Send: up to kLongestText octets
    std::string command{};   ///< as a user would type it: "move can to 10 cm, 0 cm"
    std::string toml{};      ///< the same as lines of an [[event]] table
};

inline constexpr std::size_t kLongestText = 1000;

struct Condition {
    enum class Kind : std::uint8_t {
        Near,     ///< `robot` closer than `distance` to `other`, edge to edge
        Enters,   ///< the middle of `robot` in a region: disc (`radius`) or rectangle about `at`
        Travels,  ///< `robot` has come `distance` along its path
        Led,      ///< signal `other` of `robot` ("led0", "led_front", "led_body") is `on`
        Wheels,   ///< the motors of `robot` step (`on`) or rest
        After,    ///< event `other` was carried out
    };
    Kind kind = Kind::After;
    std::string robot{}, other{};
    Point at{};
    double radius = 0.0;               ///< > 0: disc
    double length = 0.0, width = 0.0;  ///< along x and y
    double distance = 0.0;
    bool on = true;
};

struct Event {
    std::string name{};  ///< "event 3" if the user gave none
    std::string file{};
    Place place{};
    std::optional<cosim::Time> at{};
    std::optional<Condition> when{};  ///< one of the two is set
    cosim::Time delay = 0;            ///< after the condition
    cosim::Time every = 0;            ///< repetition of `at`; 0: none
    /// How often at most: with `every` (0: to the end of the run), or how often the condition may come true.
    std::uint64_t count = 1;
    Action action{};
};

/// That Send can reach.
struct Computer {
    std::string name{};
    std::uint32_t address = 0;  ///< IPv4: 10.0.0.1 is 0x0A000001
};

/// All that may happen to one world.
struct EventPlan {
    std::vector<Event> events{};
    std::vector<Computer> computers{};
    bool live = false;     ///< commands may come in while it runs
    bool mission = false;  ///< a mission program may act (physics/tracker)
    bool repeats =
        true;  ///< a run with the same events is the same run; false: programs have a clock of their own
    std::string journal{};  ///< file for what was done, as [[event]] tables with times; empty: none

    /// Can anything happen? A world without is as if there were no events at all.
    bool any() const { return live || mission || !events.empty(); }
    /// Can a datagram be sent?
    bool may_send() const;
};

/// What is wrong with an action whatever world it is done to: ranges, sizes. Empty: nothing.
std::string problem_of(const Action& action);
/// The same of who a datagram is for.
std::string problem_of_computer(const EventPlan& plan, std::string_view name);
/// Throws InputError naming the event and its place: objects that do not exist, places outside the arena, in
/// a wall or in something that no event moves. `world` must have passed check().
void check_events(const EventPlan& plan, const World& world);

std::string to_json(const EventPlan& plan);
/// Throws InputError on anything that to_json would not have written.
EventPlan plan_from_json(std::string_view text);

}  // namespace puckloop::physics
