// SPDX-License-Identifier: Apache-2.0
#include "server/archive/sample_table.hpp"

#include <cmath>

namespace aeolis::archive {

SampleTable::SampleTable(std::filesystem::path file, sqlite::Database database, sqlite::Statement insert)
    : file_(std::move(file)), database_(std::move(database)), insert_(std::move(insert)) {}
SampleTable::SampleTable(SampleTable&& other) noexcept
    : file_(std::exchange(other.file_, {})), database_(std::move(other.database_)), insert_(std::move(other.insert_)) {}

SampleTable::~SampleTable() {
    if (file_.empty()) return;
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
}

Result<SampleTable> SampleTable::create(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored))
        return Error{file.string() + " is there already: nothing is overwritten"};
    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
    if (!database) return database.error();
    // No journal is needed: the file can be made again, and exists only when finish() is done.
    constexpr char begin[] = "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;"
                             "CREATE TABLE samples (run INTEGER NOT NULL, channel TEXT NOT NULL, sclk REAL NOT NULL,"
                             " e_s REAL, value REAL, unit TEXT NOT NULL, source TEXT NOT NULL, text TEXT) STRICT;"
                             "BEGIN";
    if (auto done = database->execute(begin); !done) return done.error();
    auto insert = database->prepare("INSERT INTO samples VALUES (?,?,?,?,?,?,?,?)");
    if (!insert) return insert.error();
    return SampleTable(file, std::move(*database), std::move(*insert));
}

Result<void> SampleTable::add(RunId run, Sclk entry, const dictionary::Dictionary& dictionary,
                              std::span<const ChannelValue> samples) {
    for (const ChannelValue& sample : samples) {
        const auto& channel = dictionary.channels[sample.channel.value];
        insert_.bind(1, std::int64_t{run.value})
            .bind(2, std::string_view(channel.name))
            .bind(3, sample.sclk.seconds)
            .bind(6, std::string_view(channel.type.unit))
            .bind(7, std::string_view(sample.source == Source::realtime ? "realtime" : "recorded"));
        if (entry.seconds == 0.0)
            insert_.bind_null(4);
        else
            insert_.bind(4, sample.sclk.seconds - entry.seconds);
        if (std::isnan(sample.value))
            insert_.bind_null(5);
        else
            insert_.bind(5, sample.value);
        if (sample.text)
            insert_.bind(8, std::string_view(*sample.text));
        else
            insert_.bind_null(8);
        if (auto done = insert_.run(); !done) return done;
    }
    return {};
}

Result<void> SampleTable::finish() {
    auto done = database_.execute("COMMIT; CREATE INDEX samples_by_channel ON samples (run, channel, sclk)");
    if (done) file_.clear();
    return done;
}

}  // namespace aeolis::archive
