// SPDX-License-Identifier: Apache-2.0
// The real program starts on an archive of a hundred landings, up to the first answer with data: after a clean end, and
// after its writer was killed during a landing. One landing is flown and the others are copies of all its rows, so that
// each table has the size it would have.

#include "bench/must.hpp"
#include "server/archive/schema.hpp"
#include "server/archive/sqlite.hpp"
#include "tests/support/temporary_folder.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

using namespace aeolis;
using namespace aeolis::bench;
namespace sqlite = archive::sqlite;

namespace {

constexpr int runs = 100, starts = 3;
constexpr double goal_s = 1.0;
constexpr const char* address = "127.0.0.1:18753";
const std::string program = AEOLIS_SOURCE_DIR "/build/release/aeolis";

double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// SQL that copies the rows of run 1 in this table to run 1 + ?1.
std::string copy_sql(sqlite::Database& database, const archive::RunTable& table) {
    const std::string_view name = table.name;
    if (name == "search")
        return "INSERT INTO search (rowid, text) SELECT key + (?1 << 40), text FROM search_text WHERE key >> 40 = 1";
    const bool of_block = name == "segment_columns" || name == "pyramid_columns";
    auto columns = database.prepare("SELECT name FROM pragma_table_info(?1) ORDER BY cid");
    must(columns.ok(), "columns");
    columns->bind(1, name);
    std::string selected;
    while (*columns->step()) {
        const std::string column{columns->text(0)};
        selected += selected.empty() ? "" : ", ";
        if (column == "run")
            selected += "run + ?1";
        else if (column == "key")
            selected += of_block ? "key + (?1 << 39)" : "key + (?1 << 40)";
        else if ((column == "segment" && name == "segments") || (column == "block" && name == "pyramid"))
            selected += column + " + (?1 << 23)";
        else
            selected += column;
    }
    std::string rows = table.rows;
    for (auto at = rows.find("?1"); at != std::string::npos; at = rows.find("?1")) rows.replace(at, 2, "1");
    return "INSERT INTO " + std::string(name) + " SELECT " + selected + " FROM " + table.name + " WHERE " + rows;
}

void multiply(const std::filesystem::path& file) {
    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
    must(database.ok(), "open");
    must(database->execute("PRAGMA synchronous = OFF").ok(), "synchronous");
    for (int copy = 1; copy < runs; ++copy) {
        auto transaction = sqlite::Transaction::begin_write(*database);
        must(transaction.ok(), "begin");
        // The index of words last: it reads the rows that it indexes.
        for (auto table = archive::run_tables().rbegin(); table != archive::run_tables().rend(); ++table) {
            auto rows = database->prepare(copy_sql(*database, *table).c_str());
            must(rows.ok(), table->name);
            rows->bind(1, std::int64_t{copy});
            must(rows->run().ok(), table->name);
        }
        must(transaction->commit().ok(), "commit");
    }
    must(database->execute("PRAGMA wal_checkpoint(TRUNCATE)").ok(), "checkpoint");
}

class Server {
  public:
    explicit Server(const std::filesystem::path& file) : began_s_(now_s()), child_(::fork()) {
        must(child_ >= 0, "fork");
        if (child_ != 0) return;
        must(std::freopen("/dev/null", "w", stdout) != nullptr && std::freopen("/dev/null", "w", stderr) != nullptr,
             "freopen");
        ::execl(program.c_str(), program.c_str(), "serve", "--listen", address, "--archive", file.c_str(),
                static_cast<char*>(nullptr));
        ::_exit(1);
    }
    /// Time from the start to the first answer of this kind.
    double first_answer_s(const std::string& what) const {
        const auto ask = std::string("curl -sf --max-time 5 -o /dev/null 'http://") + address + what + "'";
        while (now_s() - began_s_ < 60.0) {
            if (std::system(ask.c_str()) == 0) return now_s() - began_s_;
            std::this_thread::sleep_for(std::chrono::milliseconds{5});
        }
        must(false, "the server's first answer");
        return 0.0;
    }
    void end(int signal) const {
        ::kill(child_, signal);
        ::waitpid(child_, nullptr, 0);
    }

  private:
    double began_s_;
    pid_t child_;
};

bool goal(const char* what, double figure_s) {
    std::printf("  %-60s %9.0f ms, goal %.0f: ratio %.2f\n", what, 1e3 * figure_s, 1e3 * goal_s, figure_s / goal_s);
    std::fflush(stdout);  // before the next fork
    return figure_s <= goal_s;
}

}  // namespace

int main() {
    const test::TemporaryFolder folder;
    const auto file = folder / "runs.db";
    const auto flown = program + " rehearse --scenario nominal_auto --archive " + file.string() + " >/dev/null";
    must(std::system(flown.c_str()) == 0, flown.c_str());
    multiply(file);
    std::printf("aeolis serve on an archive of %d landings, %.2f GB\n", runs,
                static_cast<double>(std::filesystem::file_size(file)) * 1e-9);
    std::fflush(stdout);
    const std::string plot = "/api/v1/runs/57/channels?names=altitude_m&points=500";
    bool met = true;
    for (int i = 0; i < starts; ++i) {
        const Server server{file};
        met = goal("from its start to the first plotted channel", server.first_answer_s(plot)) && met;
        met = goal("to the list of runs, asked after it", server.first_answer_s("/api/v1/runs")) && met;
        server.end(SIGTERM);
    }
    for (int i = 0; i < starts; ++i) {
        {
            const Server server{file};
            server.first_answer_s(plot);
            const auto start =
                std::string("curl -sf -o /dev/null -d '{\"scenario\":\"nominal_auto\",\"pace\":0}' http://") + address +
                "/api/v1/rehearsals";
            must(std::system(start.c_str()) == 0, "a rehearsal");
            std::this_thread::sleep_for(std::chrono::seconds{2});
            server.end(SIGKILL);
        }
        const Server server{file};
        met = goal("after kill -9 in a landing, to the first plotted channel", server.first_answer_s(plot)) && met;
        server.end(SIGTERM);
    }
    return met ? 0 : 1;
}
