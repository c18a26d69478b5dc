using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Sends an effect to the server: the whole effect when it is new or has changed, otherwise only its movement.</summary>
    public abstract partial class HapticEffect
    {
        private const string Objects = "$.objects"; // the path of an object begins with this
        private const double Recent = 1.0; // [s]

        private string _name = "";
        private int _known, _there; // the sessions in which it was last prepared, and in which the server has it
        private bool _changed;
        private double _begin, _put; // when it was played, and last sent [s]
        private MotionTracker _tracker;
        private HapticEnvelope _told;
        private int _version;

        /// <summary>Sends what has changed; called each frame. toArray: transform from the world to the array. now: [s].</summary>
        internal void Send(HapticClient client, int session, Rigid toArray, double now)
        {
            Expire(now);
            Rigid pose = toArray * ShapePose;
            bool near = WireSpace.IsInRange(pose.Position);
            if (_there != session)
            {
                _there = 0;
            }
            if (!Playing || !near)
            {
                Withdraw(client);
                _known = 0;
                return;
            }
            if (_known != session || _changed || Reshaped())
            {
                Put(client, session, pose, now);
            }
            else if (_there == session)
            {
                Follow(client, pose, now);
            }
        }

        /// <summary>
        /// Handles an object that the server rejected, together with the rest of its message. That object is not sent
        /// again until it changes. All others are sent again. If there are too many, it concerns what was sent in the last
        /// second.
        /// </summary>
        internal static void Refuse(HapticClient client, Refusal why)
        {
            if (why.Path == null || !why.Path.StartsWith(Objects, System.StringComparison.Ordinal))
            {
                return;
            }
            bool all = why.Path == Objects;
            double now = Time.realtimeSinceStartupAsDouble;
            foreach (HapticEffect effect in All)
            {
                bool there = effect._there != 0;
                if (why.Path.StartsWith(Objects + "[" + effect._name + "]", System.StringComparison.Ordinal)
                    || (all && there && now - effect._put < Recent))
                {
                    effect.Problem = why.Message;
                    effect.Withdraw(client);
                    continue;
                }
                effect._changed |= there && !all; // one that was refused before stays away
            }
        }

        private void Expire(double now)
        {
            if (Playing && duration > 0f && now - _begin >= duration)
            {
                Playing = false;
                Finished?.Invoke();
            }
        }

        private void Withdraw(HapticClient client)
        {
            if (_there != 0)
            {
                client.Remove(_name);
            }
            _there = 0;
            _tracker.Forget();
        }

        private void Put(HapticClient client, int session, Rigid pose, double now)
        {
            string problem;
            HapticObject felt = Describe(out problem);
            if (felt != null)
            {
                ApplySettings(felt, now);
                Place(felt, pose);
                problem = ObjectValidation.Problem(felt);
            }
            Tell(problem);
            _changed = false;
            _known = session;
            if (problem.Length > 0)
            {
                Withdraw(client);
                return;
            }
            Movement movement;
            _tracker.Next(pose, now, out movement);
            _put = now;
            if (client.Put(_name, felt))
            {
                _there = session;
            }
            else
            {
                Withdraw(client);
            }
        }

        private void Follow(HapticClient client, Rigid pose, double now)
        {
            int version = envelope == null ? 0 : envelope.Version;
            if (envelope != _told || version != _version)
            {
                client.Envelope(_name, GetEnvelope());
            }
            Movement movement;
            if (_tracker.Next(pose, now, out movement))
            {
                movement.Moving = movement.Moving && predictMotion;
                client.Move(_name, movement);
            }
        }

        private void ApplySettings(HapticObject felt, double now)
        {
            felt.RadiationPressure = strength == HapticStrength.RadiationPressure ? (double?)radiationPressure : null;
            felt.Force = strength == HapticStrength.Force ? (double?)force : null;
            felt.Envelope = GetEnvelope();
            felt.Technique = technique.Message;
            felt.Material.Stiffness = stiffness > 0f ? (double?)stiffness : null;
            felt.Material.Reach = reach;
            felt.Priority = priority;
            felt.Duration = duration > 0f ? (double?)(duration - (now - _begin)) : null;
        }

        private IEnvelope GetEnvelope()
        {
            _told = envelope;
            _version = envelope == null ? 0 : envelope.Version;
            return envelope == null ? HapticEnvelope.Steady : envelope.Message;
        }

        private void Tell(string problem)
        {
            if (problem.Length > 0 && problem != Problem)
            {
                Debug.LogWarning("Pacinian: " + name + " cannot be felt: " + problem, this);
            }
            Problem = problem;
        }
    }
}
