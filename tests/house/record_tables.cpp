// SPDX-License-Identifier: Apache-2.0
// record_tables: the tables of formats/records, and that of metrics, as JSON, for docs/ and the
// specifications.
#include <iostream>
#include <nlohmann/json.hpp>

#include "formats/records/certificate.hpp"
#include "formats/records/device_limits.hpp"
#include "formats/records/felt_region.hpp"
#include "formats/records/haptic_settings.hpp"
#include "formats/records/jaw_settings.hpp"
#include "formats/records/material.hpp"
#include "formats/records/quality_contract.hpp"
#include "formats/records/tick_result.hpp"
#include "formats/records/tool_settings.hpp"
#include "runtime/training/metrics.hpp"

namespace {
using namespace palpate;
using Json = nlohmann::ordered_json;

template <typename T>
struct Stored {
    static std::string name() {
        return (std::is_floating_point_v<T> ? "f" : "i") + std::to_string(8 * sizeof(T));
    }
};
template <typename T, std::size_t size>
struct Stored<std::array<T, size>> {
    static std::string name() { return Stored<T>::name() + " (N, " + std::to_string(size) + ")"; }
};

template <typename Record, typename Table>
Json rows_of(const Table& table) {
    Json rows = Json::array();
    for_each_field(
        table, [&]<typename Row, typename T, typename Storage>(const Field<Row, T, Storage>& field) {
            const Record defaults{};
            const T value = defaults.*field.member;
            Json row{{"name", field.name},
                     {"key", key_of(field)},
                     {"option", option_name(field.name)},
                     {"type", Stored<Storage>::name()},
                     {"unit", field.unit},
                     {"written_unit", field.written_unit != nullptr ? field.written_unit : field.unit},
                     {"default", value},
                     {"range", to_string(field.range)},
                     {"written_range", to_string(field.range.in_units(field.written_factor))},
                     {"written_factor", field.written_factor},
                     {"schema", field.schema},
                     {"meaning", field.meaning}};
            if (field.absent) row["absent"] = *field.absent;
            rows.push_back(std::move(row));
        });
    return rows;
}

Json fault_rows() {
    Json rows = Json::array();
    for (const FaultText& text : fault_texts())
        rows.push_back({{"flag", static_cast<std::uint32_t>(text.fault)},
                        {"name", text.name},
                        {"cause", text.cause},
                        {"remedy", text.remedy}});
    return rows;
}

}  // namespace

int main() {
    std::cout << Json{{"haptics", rows_of<HapticSettings>(haptic_fields)},
                      {"quality", rows_of<QualityContract>(quality_fields)},
                      {"material", rows_of<Material>(material_fields)},
                      {"relaxation", rows_of<RelaxationTerm>(relaxation_fields)},
                      {"certificate", rows_of<Certificate>(certificate_fields)},
                      {"feel", rows_of<FeltRegion>(felt_region_fields)},
                      {"tool", rows_of<ToolSettings>(tool_fields)},
                      {"jaws", rows_of<JawSettings>(jaw_fields)},
                      {"device_limits", rows_of<DeviceLimits>(device_limit_fields)},
                      {"tick", rows_of<Tick>(tick_fields)},
                      {"contact", rows_of<Contact>(contact_fields)},
                      {"metrics", rows_of<training::Metrics>(training::metric_fields)},
                      {"faults", fault_rows()}}
                     .dump(1)
              << '\n';
}
