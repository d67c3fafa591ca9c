// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/archive/objects/dicom_writing.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/archive/objects/dicom_uid.hpp"
#include "tools/archive/objects/placeholders.hpp"

namespace palpate::archive {
namespace {

void require_good(const OFCondition& condition, const DcmTagKey& key) {
    if (condition.bad())
        throw SystemFailure({fmt::format("DICOM attribute ({:04x},{:04x})", key.getGroup(), key.getElement()),
                             condition.text(), "", ""});
}

void put_patient(DcmItem& item, const Filing& filing, const std::string& digest) {
    const bool named = filing.identity && filing.reference;
    const auto known = [&](const DcmTagKey& key) -> std::string {
        if (!named) return "";
        const auto found = filing.reference->identity.find({key.getGroup(), key.getElement()});
        return found == filing.reference->identity.end() ? "" : found->second;
    };
    for (const DcmTagKey& key : {DCM_PatientName, DCM_PatientID, DCM_PatientBirthDate, DCM_PatientSex,
                                 DCM_StudyDate, DCM_StudyTime, DCM_StudyID, DCM_AccessionNumber})
        put(item, key, known(key));
    if (const std::string issuer = known(DCM_IssuerOfPatientID); !issuer.empty())
        put(item, DCM_IssuerOfPatientID, issuer);
    put(item, DCM_ReferringPhysicianName, "");
    if (named) return;
    put(item, DCM_PatientName, std::string(anonymous_name));
    put(item, DCM_PatientID, std::string(anonymous_id_prefix) + digest.substr(0, 12));
    put(item, DCM_PatientIdentityRemoved, "YES");
    put(item, DCM_DeidentificationMethod, "Palpate writes no attribute of a patient");
}

}  // namespace

void put(DcmItem& item, const DcmTagKey& key, const std::string& value) {
    require_good(item.putAndInsertOFStringArray(key, OFString(value.data(), value.size())), key);
}

void put(DcmItem& item, const DcmTagKey& key, Uint16 value) {
    require_good(item.putAndInsertUint16(key, value), key);
}

DcmItem& add_item(DcmItem& item, const DcmTagKey& sequence) {
    DcmItem* added = nullptr;
    require_good(item.findOrCreateSequenceItem(sequence, added, -2), sequence);
    return *added;
}

void add_code(DcmItem& item, const DcmTagKey& sequence, const Code& code) {
    DcmItem& coded = add_item(item, sequence);
    put(coded, DCM_CodeValue, code.value);
    put(coded, DCM_CodingSchemeDesignator, code.scheme);
    put(coded, DCM_CodeMeaning, code.meaning);
}

std::string decimal(double value) {
    constexpr std::size_t longest = 16;
    for (int digits = 17; digits > 1; --digits)
        if (std::string text = fmt::format("{:.{}g}", value == 0 ? 0.0 : value, digits);
            text.size() <= longest)
            return text;
    return "0";
}

void require_short_text(const std::string& text, const std::string& what, const std::string& culprit) {
    const auto characters = std::ranges::count_if(
        text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });  // of UTF-8
    const bool plain =
        std::ranges::none_of(text, [](char c) { return c == '\\' || static_cast<unsigned char>(c) < ' '; });
    if (text.empty() || characters > 64 || !plain)
        throw InvalidInput({culprit, fmt::format("{} '{}'", what, text),
                            "1 ... 64 characters without a backslash, as DICOM has it",
                            "give it another name"});
}

void put_header(DcmItem& item, const Filing& filing, const std::string& digest, const char* sop_class,
                const std::string& modality, std::string_view description) {
    put(item, DCM_SpecificCharacterSet, "ISO_IR 192");  // UTF-8
    put(item, DCM_SOPClassUID, sop_class);
    put(item, DCM_SOPInstanceUID, uid_of(digest, "instance"));
    put_patient(item, filing, digest);
    const bool filed = filing.reference.has_value();
    put(item, DCM_StudyInstanceUID, filed ? filing.reference->study_uid : uid_of(digest, "study"));
    put(item, DCM_Modality, modality);
    put(item, DCM_SeriesInstanceUID, uid_of(digest, "series"));
    put(item, DCM_SeriesNumber, "1");
    put(item, DCM_SeriesDescription, std::string(description));
    put(item, DCM_FrameOfReferenceUID,
        filed && !filing.reference->frame_of_reference_uid.empty() ? filing.reference->frame_of_reference_uid
                                                                   : uid_of(digest, "frame of reference"));
    put(item, DCM_PositionReferenceIndicator, "");
    put(item, DCM_Manufacturer, "Palpate");
    put(item, DCM_ManufacturerModelName, "palpate export");
    put(item, DCM_DeviceSerialNumber, std::string(no_serial_number));
    put(item, DCM_SoftwareVersions, filing.version);
    put(item, DCM_InstanceNumber, "1");
    put(item, DCM_ContentDate, std::string(no_date));
    put(item, DCM_ContentTime, std::string(no_time));
}

void add_instances(DcmItem& item, const DcmTagKey& sequence, const Reference& reference) {
    std::string last;
    for (const ReferenceSlice& slice : reference.slices) {
        if (slice.sop_instance == last) continue;  // another frame of the same file
        last = slice.sop_instance;
        DcmItem& instance = add_item(item, sequence);
        put(instance, DCM_ReferencedSOPClassUID, slice.sop_class);
        put(instance, DCM_ReferencedSOPInstanceUID, slice.sop_instance);
    }
}

void save_object(const std::filesystem::path& path, DcmFileFormat& file) {
    if (const OFCondition saved = file.saveFile(path.c_str(), EXS_LittleEndianExplicit); saved.bad())
        throw SystemFailure({path.string(), std::string("could not be written: ") + saved.text(), "",
                             "check free space and permissions of its folder"});
}

}  // namespace palpate::archive
