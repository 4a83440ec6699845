#pragma once
// The network manager: robots' clients connect by TCP; it passes their messages on by robots' numbers, as far
// as distance and hops allow.

#include "linuxboard/netmanager/reach.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <chrono>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace puckloop::netmanager {

struct Options {
    std::uint16_t port = 7700;
    Limits limits{};
    std::chrono::microseconds hop_delay{0};  ///< a message is passed on so much later for each hop
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
    int number_of(const boost::asio::ip::address& address) const;

    boost::asio::io_context& io_;
    Options options_;
    boost::asio::ip::tcp::acceptor acceptor_;
    std::map<int, std::shared_ptr<Client>> clients_;  ///< by number
    Places places_;                                   ///< of those that are connected
    std::ofstream log_;
    std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

}  // namespace puckloop::netmanager
