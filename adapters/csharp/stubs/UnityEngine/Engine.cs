using System;
using System.Collections.Generic;
using System.Reflection;
using System.Runtime.CompilerServices;

[assembly: InternalsVisibleTo("UnityEditor")]

namespace UnityEngine
{
    /// <summary>Calls the components frame by frame. Not in Unity.</summary>
    public static class Engine
    {
        private static readonly List<MonoBehaviour> Behaviours = new List<MonoBehaviour>();

        /// <summary>
        /// Whether components run. Components added before <see cref="Play"/> wake up at their next change, such as
        /// SetActive.
        /// </summary>
        public static bool Playing { get; private set; }

        /// <summary>The number of components.</summary>
        public static int Count
        {
            get { return Behaviours.Count; }
        }

        /// <summary>Starts play mode without a domain reload.</summary>
        public static void Play(params Assembly[] assemblies)
        {
            foreach (Assembly assembly in assemblies)
            {
                foreach (Type type in assembly.GetTypes())
                {
                    Begin(type);
                }
            }
            Playing = true;
        }

        /// <summary>Runs a frame: Start where it is due, Update, LateUpdate.</summary>
        public static void Frame()
        {
            for (int i = 0; i < Behaviours.Count; i++)
            {
                if (Behaviours[i].On && !Behaviours[i].Started)
                {
                    Behaviours[i].Started = true;
                    Behaviours[i].Send("Start");
                }
            }
            Send("Update");
            Send("LateUpdate");
        }

        /// <summary>Calls a message of all enabled components.</summary>
        public static void Send(string message)
        {
            for (int i = 0; i < Behaviours.Count; i++)
            {
                if (Behaviours[i].On)
                {
                    Behaviours[i].Send(message);
                }
            }
        }

        /// <summary>Ends play mode: sends OnApplicationQuit, then disables and destroys all components.</summary>
        public static void Quit()
        {
            Send("OnApplicationQuit");
            foreach (MonoBehaviour behaviour in Behaviours.ToArray())
            {
                if (!behaviour.Destroyed)
                {
                    behaviour.enabled = false;
                    behaviour.Send("OnDestroy");
                    behaviour.Destroyed = true;
                }
            }
            Behaviours.Clear();
            Playing = false;
        }

        internal static void Add(MonoBehaviour behaviour)
        {
            int at = Behaviours.Count;
            while (at > 0 && Behaviours[at - 1].Order > behaviour.Order)
            {
                at--;
            }
            Behaviours.Insert(at, behaviour);
        }

        private static void Begin(Type type)
        {
            const BindingFlags All = BindingFlags.Static | BindingFlags.Public | BindingFlags.NonPublic;
            foreach (MethodInfo method in type.GetMethods(All))
            {
                if (method.IsDefined(typeof(RuntimeInitializeOnLoadMethodAttribute), false))
                {
                    method.Invoke(null, null);
                }
            }
        }
    }
}
