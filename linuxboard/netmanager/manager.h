#pragma once
// The network manager: robots' clients connect by TCP; it passes their messages on by robots' numbers, as far
// as distance and hops allow.

#include "linuxboard/netmanager/settings.h"
#include "linuxboard/netmanager/traffic.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>

#include <array>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>

namespace puckloop::netmanager {

struct Options {
    std::uint16_t port = 7700;
    std::uint16_t control = 7701;               ///< UDP, for changes of the settings; 0: none
    Settings settings{};                        ///< at first
    std::uint64_t seed = 1;                     ///< of what is lost
    std::chrono::microseconds status_every{0};  ///< at most so often the status is printed; 0: never
    /// Numbers by address; others have the last part of their address.
    std::map<std::string, int> numbers{};
    std::string log{};  ///< CSV file of events; empty: none
};

class Client;

class Manager {
  public:
    /// Listens. Throws std::runtime_error naming what could not be opened.
    Manager(boost::asio::io_context& io, Options options);
    ~Manager();

    /// A robot's whole line, without CR.
    void receive(Client& client, std::string_view line);
    void gone(Client& client, const std::string& why);
    /// A line to the log and, but for messages, to standard output.
    void note(const char* event, int from, int to, int hops, std::size_t octets);

  private:
    void accept();
    void welcome(boost::asio::ip::tcp::socket socket);
    void pass(int from, int to, int hops, const std::string& data);
    void listen_for_settings();
    std::string obey(std::string_view words);
    /// The status is to be printed, not now but soon.
    void stir();
    void print_status();
    double seconds() const;
    bool is_lost(int from, int to);
    int number_of(const boost::asio::ip::address& address) const;

    boost::asio::io_context& io_;
    Options options_;
    Settings settings_;
    boost::asio::ip::tcp::acceptor acceptor_;
    boost::asio::ip::udp::socket control_;
    std::array<char, 2000> words_{};  ///< of a datagram
    boost::asio::ip::udp::endpoint asker_;
    boost::asio::steady_timer status_timer_;
    bool status_due_ = false;
    Traffic traffic_;
    std::mt19937_64 random_;
    std::map<int, std::shared_ptr<Client>> clients_;  ///< by number
    Places places_;                                   ///< of those that are connected
    std::ofstream log_;
    std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

}  // namespace puckloop::netmanager
