// SPDX-License-Identifier: GPL-3.0-or-later
// DCMTK's headers first: its configuration macros must not be seen twice.
#include <algorithm>
#include <array>
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <fmt/format.h>
#include <map>
#include <set>

#include "tools/archive/objects/placeholders.hpp"
#include "tools/archive/privacy/searches.hpp"
#include "tools/imaging/dicom/dicom_structure.hpp"

namespace palpate::archive {
namespace {

// Attributes of PS3.15 table E.1-1 (basic application level confidentiality profile) that their type, see
// kind_of(), does not tell already.
const std::set<std::uint32_t>& profile() {
    static const std::set<std::uint32_t> tags{
        0x00080050, 0x00080054, 0x00080080, 0x00080081, 0x00080082, 0x00080092, 0x00080094, 0x00080201,
        0x00081010, 0x00081030, 0x0008103E, 0x00081040, 0x00081080, 0x00082111, 0x00084000, 0x00100020,
        0x00100021, 0x00100032, 0x00100040, 0x00100050, 0x00101000, 0x00101002, 0x00101010, 0x00101020,
        0x00101030, 0x00101040, 0x00101050, 0x00101080, 0x00101081, 0x00101090, 0x00102000, 0x00102110,
        0x00102150, 0x00102152, 0x00102154, 0x00102160, 0x00102180, 0x001021A0, 0x001021B0, 0x001021C0,
        0x001021F0, 0x00102203, 0x00104000, 0x00120010, 0x00120020, 0x00120021, 0x00120030, 0x00120031,
        0x00120040, 0x00120042, 0x00120050, 0x00120060, 0x00181000, 0x00181002, 0x00181004, 0x00181005,
        0x00181007, 0x00181008, 0x00181030, 0x00181400, 0x00184000, 0x00189424, 0x0018A003, 0x00200010,
        0x00203401, 0x00204000, 0x00209158, 0x00280303, 0x00321021, 0x00321020, 0x00321030, 0x00321060,
        0x00321070, 0x00324000, 0x00380010, 0x00380011, 0x00380040, 0x00380050, 0x00380060, 0x00380061,
        0x00380062, 0x00380300, 0x00380400, 0x00380500, 0x00384000, 0x00400001, 0x00400007, 0x00400009,
        0x00400010, 0x00400011, 0x00400012, 0x00400241, 0x00400242, 0x00400243, 0x00400253, 0x00400254,
        0x00400280, 0x00400310, 0x00401001, 0x00401002, 0x00401005, 0x00401400, 0x00402001, 0x00402008,
        0x00402009, 0x00402010, 0x00402016, 0x00402017, 0x00402400, 0x00403001, 0x0040A027, 0x0040A123,
        0x0040A160, 0x00400512, 0x00400551, 0x00700086, 0x00880200, 0x00880904, 0x00880906, 0x00880910,
        0x00880912, 0x04000100, 0x20300020, 0x300A0002, 0x300A0003, 0x30060002, 0x30060004, 0x30060006};
    return tags;
}

// UIDs that tell one study, image or device, not a kind of thing.
bool names_an_instance(const DcmTagKey& key) {
    static const std::set<std::uint32_t> tags{0x00020003, 0x00080014, 0x00080018, 0x00081155, 0x00081195,
                                              0x00083010, 0x0020000D, 0x0020000E, 0x00200052, 0x00200200,
                                              0x00209161, 0x00209164, 0x0040A124, 0x0040DB0D, 0x00620021,
                                              0x00880140, 0x30060024, 0x300600C2, 0x300A0013, 0x0020000B};
    return tags.contains(std::uint32_t{key.getGroup()} << 16 | key.getElement());
}

// Values that stand for none: ours, and those that tell nothing in any file.
bool tells_nothing(const DcmTagKey& key, const std::string& value) {
    const std::array words{anonymous_name,      no_date,       no_time, no_serial_number,
                           segmentation_series, surface_series};
    if (std::ranges::find(words, value) != words.end()) return true;
    if (key != DCM_PatientID || !value.starts_with(anonymous_id_prefix)) return false;
    const std::string rest = value.substr(anonymous_id_prefix.size());
    return rest.size() == 12 && rest.find_first_not_of("0123456789abcdef") == std::string::npos;
}

// What an attribute with a value is told as; empty for one that tells nothing by being there.
std::string kind_of(const DcmTagKey& key, DcmEVR type, const std::string& value) {
    const std::uint32_t tag = std::uint32_t{key.getGroup()} << 16 | key.getElement();
    if (key.getElement() == 0 || tells_nothing(key, value)) return "";  // 0: a group's length
    if (key.getGroup() % 2 != 0) return "private attribute";
    if (type == EVR_PN) return "person's name";
    if (type == EVR_DA || type == EVR_DT) return key == DCM_PatientBirthDate ? "date of birth" : "date";
    if (type == EVR_TM) return "time";
    if (type == EVR_UI)
        return names_an_instance(key) && !value.starts_with("2.25.") && !value.starts_with("1.2.840.10008.")
                   ? "UID"
                   : "";
    if (key.getGroup() == 0x0010) return "patient attribute";
    if (profile().contains(tag)) return "study attribute";
    if (type == EVR_AE) return "name of a machine";
    if (key == DCM_DocumentTitle) return "";  // what a model shows; it is searched as text
    return type == EVR_ST || type == EVR_LT || type == EVR_UT ? "free text" : "";
}

bool is_text(DcmEVR type) {
    static const std::set<DcmEVR> types{EVR_LO, EVR_SH, EVR_ST, EVR_LT, EVR_UT, EVR_UC, EVR_UR, EVR_CS};
    return types.contains(type);
}

// Equal findings, as of the same attribute on hundreds of frames, are told once.
using Seen = std::map<std::string, int>;

void search_item(DcmItem& item, const std::filesystem::path& file, const Machine& machine, Seen& seen,
                 Findings& findings) {
    for (unsigned long n = 0; n < item.card(); ++n) {
        DcmElement* element = item.getElement(n);
        if (element == nullptr) continue;
        const DcmTag tag = element->getTag();
        if (auto* sequence = dynamic_cast<DcmSequenceOfItems*>(element)) {
            for (unsigned long i = 0; i < sequence->card(); ++i)
                search_item(*sequence->getItem(i), file, machine, seen, findings);
            continue;
        }
        std::string value;
        OFString text;
        if (tag.getXTag() != DCM_PixelData && tag.getXTag() != DCM_EncapsulatedDocument &&
            element->getLength() < 100000 && element->getOFStringArray(text).good())
            value.assign(text.c_str(), text.size());
        if (value.empty() && tag.getGroup() % 2 != 0 && element->getLength() > 0) value = "binary";
        value.erase(value.find_last_not_of(" \\") + 1);
        if (value.empty()) continue;
        const std::string where = fmt::format("({:04x},{:04x}) {}", tag.getGroup(), tag.getElement(),
                                              tag.getGroup() % 2 != 0 ? "" : DcmTag(tag).getTagName());
        if (const std::string kind = kind_of(tag.getXTag(), element->ident(), value); !kind.empty()) {
            if (seen[where + kind]++ == 0) findings.push_back({file, where, kind, shortened(value)});
        } else if (is_text(element->ident())) {
            Findings more;
            search_text(value, file, where, false, machine, more);
            for (const Finding& finding : more)
                if (seen[where + finding.kind]++ == 0) findings.push_back(finding);
        }
    }
}

}  // namespace

bool search_dicom(const std::filesystem::path& file, const Machine& machine, Findings& findings) {
    imaging::require_sound_dicom(file);
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    DcmFileFormat format;
    if (format.loadFile(file.c_str()).bad()) return false;
    Seen seen;
    search_item(*format.getMetaInfo(), file, machine, seen, findings);
    search_item(*format.getDataset(), file, machine, seen, findings);
    const Uint8* document = nullptr;
    unsigned long bytes = 0;
    if (format.getDataset()->findAndGetUint8Array(DCM_EncapsulatedDocument, document, &bytes).good()) {
        constexpr unsigned long stl_header = 80;
        search_text({reinterpret_cast<const char*>(document), std::min(bytes, stl_header)}, file,
                    "start of the encapsulated document", false, machine, findings);
        search_bytes({reinterpret_cast<const char*>(document), bytes}, file, machine, findings);
    }
    return true;
}

}  // namespace palpate::archive
