// SPDX-License-Identifier: Apache-2.0
#include "server/access/secrets.hpp"
#include "server/base/json.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/net/http_client.hpp"

#include "aeolis/v1/run.pb.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <sstream>

namespace aeolis::server {
namespace {

struct SendOptions {
    std::filesystem::path file;  ///< a command file: a CommandSequence as JSON
    std::string server = "http://127.0.0.1:8080";
    std::string token;                  ///< of a server with accounts
    std::filesystem::path authorities;  ///< PEM; empty: the system's
    std::string by;                     ///< the asker, unless the file names one
    std::optional<std::uint32_t> run;   ///< none: the current run
    std::string id;                     ///< of this sending; empty: a new one
    bool dry_run = false;
};

Result<v1::CommandSequence> sequence_of(const SendOptions& options) {
    std::ifstream file{options.file, std::ios::binary};
    std::ostringstream text;
    text << file.rdbuf();
    if (!file) return Error{fmt::format("--file {}: it cannot be read", options.file.string())};
    v1::CommandSequence sequence;
    if (const auto parsed = from_json(text.str(), sequence); !parsed)
        return Error{fmt::format("--file {}: {}", options.file.string(), parsed.error().message)};
    if (options.dry_run) sequence.set_dry_run(true);
    int place = 0;
    for (auto& command : *sequence.mutable_commands()) {
        ++place;
        if (command.controller().empty()) command.set_controller(options.by);
        if (command.client_id().empty()) command.set_client_id(fmt::format("{}-{}", options.id, place));
    }
    return sequence;
}

std::string of_one(const v1::CommandReply& reply) {
    if (!reply.accepted()) return "refused: " + reply.reason();
    if (reply.repeated())
        return fmt::format("is command {} already: not sent again; {}", reply.command(), reply.fate().evidence());
    std::string text = reply.command() == 0 ? "would be taken" : fmt::format("is command {}", reply.command());
    text += fmt::format(", {} octets", reply.octets().size() / 2);
    if (!reply.arrives().empty()) text += fmt::format(", at the vehicle {} SCET", reply.arrives());
    if (!reply.latest_useful().empty())
        text += fmt::format(", to leave by {} ERT to be there before {}", reply.latest_useful(), reply.useful_before());
    if (!reply.reason().empty()) text += ", " + reply.reason();
    if (reply.needs_approval()) text += ", waits for a second person";
    return text;
}

constexpr int exit_not_known = 3;
constexpr std::size_t id_length = 16;  // chosen: 64 bits or more of chance

/// Reports that the server may have taken all of the file or nothing.
int perhaps_taken(const v1::CommandSequence& sequence, const std::string& why, const SendOptions& options) {
    if (sequence.dry_run()) return failed("send: a dry run, nothing was sent: " + why);
    return failed(
        fmt::format(
            "send: {}: it is not known whether the commands were taken: while this run goes on, send the file again "
            "with --id {}; commands that were taken are not taken again",
            why, options.id),
        exit_not_known);
}

/// Sends a command file to a server. Returns 0: all taken; 3: unknown; else nothing was taken.
int send(const SendOptions& options) {
    const auto sequence = sequence_of(options);
    if (!sequence) return failed("send: " + sequence.error().message, 2);
    const HttpClient client{{.server = options.server, .token = options.token, .authorities = options.authorities}};
    const auto answer =
        client.post(fmt::format("/api/v1/runs/{}/sequences", options.run ? std::to_string(*options.run) : "latest"),
                    to_json(*sequence));
    if (!answer) return failed("send: nothing was sent: " + answer.error().message);
    if (!answer->lost.empty()) return perhaps_taken(*sequence, answer->lost, options);
    v1::ErrorReply problem;  // that has nothing of a SequenceReply
    if (from_json(answer->body, problem))
        return failed(fmt::format("send: refused ({}): {}", answer->status,
                                  problem.detail().empty() ? problem.error() : problem.detail()));
    v1::SequenceReply reply;
    if (!from_json(answer->body, reply))
        return perhaps_taken(*sequence, fmt::format("the answer ({}) is not one of Aeolis", answer->status), options);
    for (int i = 0; i < reply.commands_size() && i < sequence->commands_size(); ++i)
        fmt::print("{:>3}  {}  {}\n", i + 1, sequence->commands(i).command(), of_one(reply.commands(i)));
    const bool any =
        std::ranges::any_of(reply.commands(), [](const v1::CommandReply& each) { return each.command() != 0; });
    if (!reply.accepted())
        return failed(fmt::format("send: {}: {}",
                                  any ? "the commands with a number were taken, the others not" : "nothing was sent",
                                  reply.reason()));
    if (sequence->dry_run()) fmt::print("a dry run: nothing was sent\n");
    return 0;
}

}  // namespace

void add_send_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<SendOptions>();
    auto& command = *program.add_subcommand(
        "send", "sends a command file to a server, all of its commands or none; prints a line per command; exit code 1 "
                "when nothing was sent, 3 when no answer tells whether it was");
    command.add_option("--file", options->file, "JSON, as POST /api/v1/runs/{run}/sequences takes it")->required();
    command.add_option("--server", options->server, "http://HOST:PORT or https://HOST:PORT")
        ->envname("AEOLIS_SERVER")
        ->capture_default_str();
    command
        .add_option("--token", options->token,
                    "token of a server with accounts, sent over https or to this machine only; other users can read "
                    "a command line, but not AEOLIS_TOKEN")
        ->envname("AEOLIS_TOKEN");
    command.add_option("--authorities", options->authorities,
                       "PEM file of the authorities that may have signed the server's certificate; the system's if "
                       "left out");
    command.add_option("--by", options->by, "name of the sender, for a server without accounts, if the file has none");
    command.add_option(
        "--id", options->id,
        "id of this request, 1 to 56 characters of A-Z a-z 0-9 . _ : - ; a file sent again with the same id is not "
        "executed twice in one run. A new id if left out");
    command.add_option("--run", options->run, "send only if this is the current run")->check(whole_number());
    command.add_flag("--dry-run", options->dry_run, "only report what would happen");
    command.callback([options, &exit_code] {
        if (options->id.empty()) options->id = new_secret().substr(0, id_length);
        exit_code = send(*options);
    });
}

}  // namespace aeolis::server
