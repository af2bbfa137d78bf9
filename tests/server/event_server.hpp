// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/net/web_server.hpp"

#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace aeolis::test {

/// A server of the stream with events and nothing behind it: no archive, no landing.
class EventServer {
  public:
    explicit EventServer(const server::WebServer::Settings& settings = {}) {
        server::StreamHub::Services services;
        services.want_items = [](bool) {};
        hub_ = std::make_unique<server::StreamHub>(std::uint16_t{1}, services);
        v1::RunState state;
        state.set_run(1);
        hub_->run_state(state);
        server::WebServer::Handlers handlers;
        handlers.request = [](const server::HttpRequest&, const server::Respond& respond) { respond({}); };
        handlers.admit_stream = [](const server::Credentials&) { return server::HttpResponse{}; };
        handlers.open_stream = [this](const server::Credentials&, server::StreamFormat format,
                                      std::function<void()> wake) {
            return std::make_shared<server::StreamSession>(*hub_, format, std::move(wake),
                                                           server::StreamSession::follower());
        };
        auto opened = server::WebServer::open(settings, handlers);
        if (!opened) throw std::runtime_error(opened.error().message);
        server_ = std::move(*opened);
        network_ = std::thread{[this] { server_->run(); }};
    }
    ~EventServer() {
        end();
        server_.reset();
    }
    /// Ends it as a signal to the program does.
    void end() {
        if (!network_.joinable()) return;
        server_->stop();
        network_.join();
    }
    std::uint16_t port() const { return server_->port(); }
    std::thread& network() { return network_; }
    archive::Sequence last_seq() const { return seq_; }  ///< published
    std::uint64_t octets_given() const {                 ///< to all clients, as far as their sockets take them
        std::promise<std::uint64_t> octets;
        server_->post([&] { octets.set_value(hub_->figures.octets); });
        return octets.get_future().get();
    }
    std::size_t clients() const {
        std::promise<std::size_t> count;
        server_->post([&] { count.set_value(hub_->sessions()); });
        return count.get_future().get();
    }

    /// A batch with one event for each of the texts, as the pipeline publishes them, all in one turn of the network.
    void publish(const std::vector<std::string>& texts) {
        std::vector<std::shared_ptr<const pipeline::PublishedBatch>> batches;
        for (const auto& text : texts) {
            auto batch = std::make_shared<pipeline::PublishedBatch>();
            batch->run = archive::RunId{1};
            batch->first_seq = batch->last_seq = ++seq_;
            v1::Item item;
            item.set_seq(seq_);
            item.mutable_event()->set_text(text);
            batch->items = {item};
            batches.push_back(std::move(batch));
        }
        server_->post([this, batches = std::move(batches)] {
            for (const auto& batch : batches) hub_->published(batch);
        });
    }

  private:
    std::unique_ptr<server::StreamHub> hub_;
    std::unique_ptr<server::WebServer> server_;
    std::thread network_;
    archive::Sequence seq_ = 0;
};

}  // namespace aeolis::test
