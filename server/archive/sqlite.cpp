// SPDX-License-Identifier: Apache-2.0
#include "server/archive/sqlite.hpp"

#include "common/check.hpp"

#include <bit>
#include <cctype>
#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

namespace aeolis::archive::sqlite {

namespace {

/// A reader never waits; a writer only for another connection's checkpoint.
constexpr int busy_timeout_ms = 250;
constexpr mode_t owner_only = 0600;
constexpr int operations_between_looks = 1000;  ///< of SQLite's virtual machine: about 20 us

/// Makes the file, if there is none. An open file is never closed here: that would drop SQLite's locks on it.
void make_private(const std::string& file) {
    const int made = ::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, owner_only);
    if (made >= 0) ::close(made);
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const {
    sqlite3_finalize(statement);
}
void Database::Close::operator()(sqlite3* database) const {
    sqlite3_close_v2(database);
}

Statement& Statement::bind(int parameter, std::int64_t value) {
    AEOLIS_CHECK(sqlite3_bind_int64(statement_.get(), parameter, value) == SQLITE_OK);
    return *this;
}
Statement& Statement::bind(int parameter, double value) {
    AEOLIS_CHECK(sqlite3_bind_double(statement_.get(), parameter, value) == SQLITE_OK);
    return *this;
}
Statement& Statement::bind(int parameter, std::string_view text) {
    // An empty view may have a null pointer, which SQLite would take for NULL.
    const char* data = text.data() == nullptr ? "" : text.data();
    AEOLIS_CHECK(sqlite3_bind_text64(statement_.get(), parameter, data, text.size(), SQLITE_STATIC, SQLITE_UTF8) ==
                 SQLITE_OK);
    return *this;
}
Statement& Statement::bind_octets(int parameter, std::span<const std::uint8_t> octets) {
    if (octets.empty()) {
        AEOLIS_CHECK(sqlite3_bind_zeroblob(statement_.get(), parameter, 0) == SQLITE_OK);
        return *this;
    }
    AEOLIS_CHECK(sqlite3_bind_blob64(statement_.get(), parameter, octets.data(), octets.size(), SQLITE_STATIC) ==
                 SQLITE_OK);
    return *this;
}
Statement& Statement::bind_null(int parameter) {
    AEOLIS_CHECK(sqlite3_bind_null(statement_.get(), parameter) == SQLITE_OK);
    return *this;
}

Result<bool> Statement::step() {
    const int code = sqlite3_step(statement_.get());
    if (code == SQLITE_ROW) return true;
    if (code == SQLITE_DONE) {
        sqlite3_reset(statement_.get());
        return false;
    }
    sqlite3* database = sqlite3_db_handle(statement_.get());
    const char* name = sqlite3_db_filename(database, "main");
    Error error{std::string(name == nullptr ? "archive" : name) + ": " + sqlite3_errmsg(database), true};
    sqlite3_reset(statement_.get());
    return error;
}

Result<void> Statement::run() {
    auto row = step();
    if (!row) return row.error();
    if (*row) reset();
    return {};
}

void Statement::reset() {
    sqlite3_reset(statement_.get());
}

std::int64_t Statement::integer(int column) const {
    return sqlite3_column_int64(statement_.get(), column);
}
double Statement::real(int column) const {
    return sqlite3_column_double(statement_.get(), column);
}
std::string_view Statement::text(int column) const {
    const auto* text = sqlite3_column_text(statement_.get(), column);
    if (text == nullptr) return {};
    return {reinterpret_cast<const char*>(text),
            static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}
std::span<const std::uint8_t> Statement::octets(int column) const {
    const auto* octets = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_.get(), column));
    if (octets == nullptr) return {};
    return {octets, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}
int Statement::columns() const {
    return sqlite3_column_count(statement_.get());
}
void Statement::append_exact(int column, std::vector<std::uint8_t>& octets) const {
    const auto append = [&](char type, const void* data, std::size_t size) {
        const auto head = type + std::to_string(size) + ':';
        octets.insert(octets.end(), head.begin(), head.end());
        const auto* first = static_cast<const std::uint8_t*>(data);
        octets.insert(octets.end(), first, first + size);
    };
    switch (sqlite3_column_type(statement_.get(), column)) {
    case SQLITE_INTEGER: {
        const auto digits = std::to_string(integer(column));
        return append('i', digits.data(), digits.size());
    }
    case SQLITE_FLOAT: {
        const auto digits = std::to_string(std::bit_cast<std::uint64_t>(real(column)));
        return append('r', digits.data(), digits.size());
    }
    case SQLITE_TEXT: return append('t', text(column).data(), text(column).size());
    case SQLITE_BLOB: return append('b', this->octets(column).data(), this->octets(column).size());
    default: return append('n', "", 0);
    }
}
bool Statement::is_null(int column) const {
    return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

Result<Database> Database::open(const std::string& file, Mode mode) {
    Database database;
    database.file_ = file;
    // NOMUTEX: each connection has one owner. URI: needed by attach_read_only().
    const int flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_URI |
                      (mode == Mode::read_only ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    if (mode == Mode::read_write_create) make_private(file);
    sqlite3* handle = nullptr;
    const int code = sqlite3_open_v2(file.c_str(), &handle, flags, nullptr);
    database.database_.reset(handle);
    if (code != SQLITE_OK) return Error{file + ": " + sqlite3_errstr(code), true};
    sqlite3_extended_result_codes(handle, 1);
    sqlite3_busy_timeout(handle, busy_timeout_ms);
    return database;
}

Result<void> Database::execute(const char* sql) {
    if (sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) == SQLITE_OK) return {};
    return error("");
}

Result<Statement> Database::prepare(const char* sql) {
    sqlite3_stmt* handle = nullptr;
    if (sqlite3_prepare_v3(database_.get(), sql, -1, SQLITE_PREPARE_PERSISTENT, &handle, nullptr) != SQLITE_OK)
        return error("");
    Statement statement;
    statement.statement_.reset(handle);
    return statement;
}

Result<std::int64_t> Database::integer_of(const char* sql) {
    auto statement = prepare(sql);
    if (!statement) return statement.error();
    auto row = statement->step();
    if (!row) return row.error();
    return *row ? statement->integer(0) : 0;
}

Result<void> Database::attach_read_only(const std::filesystem::path& file, const char* name) {
    std::string uri = "file:";
    for (const char c : std::filesystem::absolute(file).string()) {
        constexpr std::string_view plain = "/-_.~";
        constexpr std::string_view digits = "0123456789ABCDEF";
        const auto octet = static_cast<unsigned char>(c);
        if ((octet < 128 && std::isalnum(octet) != 0) || plain.find(c) != std::string_view::npos)
            uri += c;
        else
            uri.append({'%', digits[octet >> 4U], digits[octet & 15U]});
    }
    auto statement = prepare("ATTACH ?1 AS ?2");
    if (!statement) return statement.error();
    uri += "?mode=ro";
    statement->bind(1, std::string_view(uri)).bind(2, std::string_view(name));
    if (statement->run()) return {};
    return Error{file.string() + ": " + sqlite3_errmsg(database_.get()), true};
}

Result<void> Database::copy_to(Database& empty) const {
    sqlite3_backup* const backup = sqlite3_backup_init(empty.handle(), "main", database_.get(), "main");
    if (backup == nullptr) return empty.error("");
    // In one step, for one state of the file. In WAL mode a writer proceeds; only its checkpoints wait.
    const int stepped = sqlite3_backup_step(backup, -1);
    const int finished = sqlite3_backup_finish(backup);
    if (stepped == SQLITE_DONE && finished == SQLITE_OK) return {};
    return Error{file_ + ": the copy into " + empty.file_ +
                     " failed: " + sqlite3_errstr(stepped == SQLITE_DONE ? finished : stepped),
                 true};
}

void Database::stop_when(std::function<bool()> stop) {
    stop_ = std::make_unique<Stop>(Stop{std::move(stop), false});
    const auto look = [](void* given) {
        auto& asked = *static_cast<Stop*>(given);
        asked.happened = asked.happened || asked.wanted();
        return asked.happened ? 1 : 0;
    };
    if (stop_->wanted)
        sqlite3_progress_handler(database_.get(), operations_between_looks, look, stop_.get());
    else
        sqlite3_progress_handler(database_.get(), 0, nullptr, nullptr);
}

bool Database::stopped() const {
    return stop_ != nullptr && stop_->happened;
}

bool Database::moved() const {
    int moved = 0;
    return sqlite3_file_control(database_.get(), "main", SQLITE_FCNTL_HAS_MOVED, &moved) == SQLITE_OK && moved != 0;
}

bool Database::autocommit() const {
    return sqlite3_get_autocommit(database_.get()) != 0;
}

Error Database::error(std::string_view doing) const {
    std::string text = file_ + ": ";
    if (!doing.empty()) text.append(doing).append(": ");
    return {text + sqlite3_errmsg(database_.get()), true};
}

Result<Transaction> Transaction::begin_write(Database& database) {
    auto begun = database.execute("BEGIN IMMEDIATE");
    if (!begun) return begun.error();
    return Transaction(database);
}
Result<Transaction> Transaction::begin_read(Database& database) {
    auto begun = database.execute("BEGIN");
    if (!begun) return begun.error();
    return Transaction(database);
}

Transaction::~Transaction() {
    // Some errors have already rolled back.
    if (database_ != nullptr && !database_->autocommit()) (void)database_->execute("ROLLBACK").ok();
}

Result<void> Transaction::commit() {
    auto done = database_->execute("COMMIT");
    if (done) database_ = nullptr;
    return done;
}

}  // namespace aeolis::archive::sqlite
