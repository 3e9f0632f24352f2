"""One-shot contention of IEEE 802.15.4 nodes in ns-3: the peer of scenarios/mac/one-shot-star.toml.

All of N nodes get one broadcast frame of L octets (MPDU) at the same instant and hear each other at -60 dBm. Prints a line for each pair N:L:
nodes, octets, rounds, the share of the frames that overlap no other frame, the share that was given up because the channel was busy, and
the mean time from the request to the end of the frames without overlap (ms). Usage: ns3_one_shot.py ROUNDS N:L..
Needs ns-3 3.44 with its Python bindings (package ns3 3.44.post0).
"""

import sys

from ns import ns

CODE = r"""
#include "ns3/core-module.h"
#include "ns3/network-module.h"
#include "ns3/mobility-module.h"
#include "ns3/lr-wpan-module.h"
#include "ns3/propagation-module.h"
#include "ns3/spectrum-module.h"

struct OneShot
{
    std::vector<std::pair<double, uint32_t>> begins;
    uint32_t sent = 0;
    uint32_t failed = 0;
    void Begin(uint32_t node, ns3::Ptr<const ns3::Packet>) { begins.emplace_back(ns3::Simulator::Now().GetSeconds(), node); }
    void Confirm(ns3::lrwpan::McpsDataConfirmParams params)
    {
        if (params.m_status == ns3::lrwpan::MacStatus::CHANNEL_ACCESS_FAILURE) { failed++; }
    }
};

// Frames without overlap, frames given up and the sum of the ends of the former (ms), over some rounds.
std::vector<double> one_shot(uint32_t nodes, uint32_t mpdu, uint32_t rounds, uint32_t seed)
{
    using namespace ns3;
    double good = 0, failed = 0, ends = 0;
    double airtime = (6 + mpdu) * 32e-6;
    for (uint32_t round = 0; round < rounds; round++)
    {
        RngSeedManager::SetSeed(seed);
        RngSeedManager::SetRun(round + 1);
        auto channel = CreateObject<SingleModelSpectrumChannel>();
        // Received power of all links, well above the thresholds of carrier sense.
        auto loss = CreateObject<FixedRssLossModel>();
        loss->SetRss(-60.0);
        channel->AddPropagationLossModel(loss);
        auto shot = std::make_shared<OneShot>();
        std::vector<Ptr<lrwpan::LrWpanNetDevice>> devices;
        for (uint32_t i = 0; i < nodes; i++)
        {
            auto node = CreateObject<Node>();
            auto device = CreateObject<lrwpan::LrWpanNetDevice>();
            device->SetAddress(Mac16Address::Allocate());
            device->SetChannel(channel);
            node->AddDevice(device);
            auto mobility = CreateObject<ConstantPositionMobilityModel>();
            device->GetPhy()->SetMobility(mobility);
            device->GetMac()->SetMcpsDataConfirmCallback(MakeCallback(&OneShot::Confirm, shot.get()));
            device->GetPhy()->TraceConnectWithoutContext("PhyTxBegin",
                MakeCallback(&OneShot::Begin, shot.get()).Bind(i));
            devices.push_back(device);
        }
        lrwpan::McpsDataRequestParams params;
        params.m_dstPanId = 0;
        params.m_srcAddrMode = lrwpan::SHORT_ADDR;
        params.m_dstAddrMode = lrwpan::SHORT_ADDR;
        params.m_dstAddr = Mac16Address("ff:ff");
        params.m_msduHandle = 0;
        params.m_txOptions = lrwpan::TX_OPTION_NONE;
        for (uint32_t i = 0; i < nodes; i++)
        {
            // 11 octets of header and check sequence.
            auto packet = Create<Packet>(mpdu - 11);
            auto mac = devices[i]->GetMac();
            Simulator::ScheduleWithContext(i, Seconds(1.0), [mac, params, packet]() { mac->McpsDataRequest(params, packet); });
        }
        Simulator::Stop(Seconds(2.0));
        Simulator::Run();
        failed += shot->failed;
        for (auto& a : shot->begins)
        {
            bool hit = false;
            for (auto& b : shot->begins)
            {
                hit |= &a != &b && std::abs(a.first - b.first) < airtime;
            }
            if (!hit) { good++; ends += 1e3 * (a.first + airtime - 1.0); }
        }
        Simulator::Destroy();
    }
    return {good, failed, ends};
}
"""
ns.cppyy.cppdef(CODE)
rounds = int(sys.argv[1])
for pair in sys.argv[2:]:
    nodes, octets = map(int, pair.split(":"))
    good, failed, ends = ns.cppyy.gbl.one_shot(nodes, octets, rounds, 1)
    frames = rounds * nodes
    print(f"{nodes},{octets},{rounds},{good / frames:.4f},{failed / frames:.4f},{ends / max(good, 1):.3f}", flush=True)
