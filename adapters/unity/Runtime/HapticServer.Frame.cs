using System.Collections.Generic;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>
    /// Work of each frame. Update renews the lease, so a frozen game does not renew it. Changes are sent after the
    /// LateUpdate of all other components.
    /// </summary>
    public sealed partial class HapticServer
    {
        private readonly List<Wire.HandFrame> _hands = new List<Wire.HandFrame>();
        private readonly List<Wire.Zone> _zones = new List<Wire.Zone>();
        private const double ZonesPause = 1.0; // [s] until zones that were too many or late are sent again

        private readonly SelectionSender _selectionSender = new SelectionSender();
        private int _emptySession, _zonesSession; // sessions in which the empty list of hands, and all zones, were sent
        private double _zonesDue = double.PositiveInfinity; // when the zones are sent again
        private bool _arms, _handed;

        private void Update()
        {
            if (!ReferenceEquals(Current, this))
            {
                return;
            }
            if (_waits)
            {
                Begin();
            }
            StartedServer.Tick(IsConnected);
            if (Client != null)
            {
                Client.Tick();
            }
        }

        private void LateUpdate()
        {
            if (Client == null || Client.Status != ClientStatus.Connected || _session == 0)
            {
                return;
            }
            double now = Time.realtimeSinceStartupAsDouble;
            Rigid toArray = ArrayOrigin.ToArray;
            _selectionSender.Send(Client, solver, backend, intensity, now);
            SendZones(toArray, now);
            for (int i = 0; i < HapticEffect.All.Count && Client != null; i++) // a handler may disconnect
            {
                HapticEffect.All[i].Send(Client, _session, toArray, now);
            }
            if (Client == null)
            {
                return;
            }
            SendHands(toArray, now);
            if (_arms)
            {
                _arms = false;
                Arm();
            }
        }

        /// <summary>
        /// Sends the hands every frame. When there are none any more, sends an empty list once in each session;
        /// otherwise the server would render objects without hands, as a whole.
        /// </summary>
        private void SendHands(Rigid toArray, double now)
        {
            _hands.Clear();
            for (int i = 0; i < HapticHand.All.Count && _hands.Count < Wire.Protocol.MaxHands; i++)
            {
                _hands.Add(HapticHand.All[i].Frame(toArray, now));
            }
            bool any = _hands.Count > 0;
            _handed = _handed || any;
            if (any || (_handed && _emptySession != _session))
            {
                Client.Hands(_hands);
                _emptySession = any ? 0 : _session;
            }
        }

        /// <summary>Sends the zones if one has moved, appeared or disappeared, or if they are due again.</summary>
        private void SendZones(Rigid toArray, double now)
        {
            bool changed = (_zones.Count > 0 && _zonesSession != _session) || now >= _zonesDue;
            int count = 0;
            for (int i = 0; i < QuietZone.All.Count && count < Wire.Protocol.MaxZones; i++)
            {
                if (count == _zones.Count)
                {
                    _zones.Add(new Wire.Zone());
                    changed = true;
                }
                QuietZone.All[i].Write(toArray, _zones[count++], ref changed);
            }
            if (count < _zones.Count)
            {
                _zones.RemoveRange(count, _zones.Count - count);
                changed = true;
            }
            if (changed)
            {
                _zonesSession = Client.Quiet(_zones) ? _session : 0;
                _zonesDue = double.PositiveInfinity;
            }
        }

        /// <summary>
        /// Sends the zones again after a pause if there are too many until others remove theirs, or if they came late.
        /// Zones that are refused for another reason are sent again only after a change.
        /// </summary>
        private void RefuseZones(Refusal why)
        {
            if ((why.Path == "$.zones" && why.Code == "limit") || why.Path == "$.ttl")
            {
                _zonesDue = Time.realtimeSinceStartupAsDouble + ZonesPause;
            }
        }
    }
}
